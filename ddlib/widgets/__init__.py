"""Interactive figures: exact with a kernel, interpolated in the built page without one.

- ``picker``, ``switches``, ``tuner``, ``window``, ``explorer``, ``player``, ``spectrum``: a widget
  each, named after what the reader handles; ``hinton``: the diagram that two of them share
- ``beyond``: widgets of Part IV
- ``engine``: widgets that compute in the page, and the live engine that they share
- ``base``: `CurveWidget`, a function of a few parameters that returns curves
- ``parts``: parameters, panels, pads; ``baking``: values and a still for pages without a kernel
- ``static``: the page's half: scripts that all widgets share (``curves.js``, ...), and one more for
  each that draws something of its own (``picker.js``)
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    base="SCRIPT STYLE CurveWidget module",
    explorer="FilterExplorer",
    picker="TrajectoryPicker",
    player="TrainingPlayer",
    spectrum="SpectrumExplorer",
    switches="RealArmSwitches",
    tuner="PIDTuner",
    window="SlidingWindow",
    **{
        "engine.builder": "FilterBuilder",
        "engine.sentence": "LoopSentence TorqueSentence",
        "engine.throw": "ThrownArm",
        "engine.trainer": "NetworkTrainer",
        "parts.panels": "Mark Pad Panel Scalar",
        "parts.parameters": "Choice Parameter",
    },
)
