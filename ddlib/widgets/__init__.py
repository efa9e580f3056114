"""Interactive figures that work with a kernel, without one, and as a still picture."""

from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts import (
    ArmPose,
    Choice,
    Curve,
    Mark,
    Pad,
    Panel,
    Parameter,
    ParameterError,
    Readout,
    Stage,
)
from ddlib.widgets.picker import TrajectoryPicker

__all__ = [
    "ArmPose",
    "Choice",
    "Curve",
    "CurveWidget",
    "Mark",
    "Pad",
    "Panel",
    "Parameter",
    "ParameterError",
    "Readout",
    "Stage",
    "TrajectoryPicker",
]
