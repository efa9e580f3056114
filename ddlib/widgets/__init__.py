"""Interactive figures: exact with a kernel, interpolated in the built page without one.

- ``picker``, ``switches``, ``tuner``, ``window``, ``explorer``, ``player``, ``spectrum``: a widget
  each, named after what the reader handles; ``hinton``: the diagram that two of them share
- ``base``: `CurveWidget`, a function of a few parameters that returns curves
- ``parts``: parameters, panels, pads; ``baking``: values and a still for pages without a kernel
- ``static``: the page's half: scripts that all widgets share (``curves.js``, ...), and one more for
  each that draws something of its own (``picker.js``)
"""

from ddlib.widgets.base import SCRIPT, STYLE, CurveWidget, module
from ddlib.widgets.explorer import FilterExplorer
from ddlib.widgets.parts.panels import Mark, Pad, Panel, Scalar
from ddlib.widgets.parts.parameters import Choice, Parameter
from ddlib.widgets.picker import TrajectoryPicker, inside_hull
from ddlib.widgets.player import TrainingPlayer
from ddlib.widgets.spectrum import SpectrumExplorer
from ddlib.widgets.switches import RealArmSwitches
from ddlib.widgets.tuner import PIDTuner
from ddlib.widgets.window import SlidingWindow

__all__ = [
    "SCRIPT",
    "STYLE",
    "Choice",
    "CurveWidget",
    "FilterExplorer",
    "Mark",
    "PIDTuner",
    "Pad",
    "Panel",
    "Parameter",
    "RealArmSwitches",
    "Scalar",
    "SlidingWindow",
    "SpectrumExplorer",
    "TrainingPlayer",
    "TrajectoryPicker",
    "inside_hull",
    "module",
]
