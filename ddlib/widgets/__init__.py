"""Interactive figures: exact with a kernel, interpolated in the built page without one."""

from ddlib.widgets.baked import Parameter
from ddlib.widgets.base import CurveWidget, Mark, Pad, Panel, Scalar
from ddlib.widgets.picker import TrajectoryPicker

__all__ = ["CurveWidget", "Mark", "Pad", "Panel", "Parameter", "Scalar", "TrajectoryPicker"]
