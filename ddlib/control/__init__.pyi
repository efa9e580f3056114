from .controllers import (
    PID as PID,
    ComputedTorque as ComputedTorque,
    ControlLaw as ControlLaw,
    Controller as Controller,
    Feedforward as Feedforward,
    as_controller as as_controller,
    pd as pd,
    proportional as proportional,
)
from .linear import (
    closed_loop as closed_loop,
    late_poles as late_poles,
    loop_gain as loop_gain,
    margins as margins,
    opened_loop as opened_loop,
    plant as plant,
    proportional_limit as proportional_limit,
)
from .velocity import (
    EstimatedVelocity as EstimatedVelocity,
    difference as difference,
    end_slope as end_slope,
    noise_gain as noise_gain,
    stacked as stacked,
)
