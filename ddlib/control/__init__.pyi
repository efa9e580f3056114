from .controllers import (
    PID as PID,
)
from .controllers import (
    ComputedTorque as ComputedTorque,
)
from .controllers import (
    ControlLaw as ControlLaw,
)
from .controllers import (
    Controller as Controller,
)
from .controllers import (
    Feedforward as Feedforward,
)
from .controllers import (
    as_controller as as_controller,
)
from .controllers import (
    pd as pd,
)
from .controllers import (
    proportional as proportional,
)
from .linear import (
    Margins as Margins,
)
from .linear import (
    closed_loop as closed_loop,
)
from .linear import (
    loop_gain as loop_gain,
)
from .linear import (
    margins as margins,
)
from .linear import (
    opened_loop as opened_loop,
)
from .linear import (
    plant as plant,
)
from .linear import (
    proportional_limit as proportional_limit,
)
from .velocity import (
    EstimatedVelocity as EstimatedVelocity,
)
from .velocity import (
    difference as difference,
)
from .velocity import (
    end_slope as end_slope,
)
from .velocity import (
    lag as lag,
)
from .velocity import (
    noise_gain as noise_gain,
)
from .velocity import (
    stacked as stacked,
)
