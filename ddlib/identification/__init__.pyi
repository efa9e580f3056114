from .equations import (
    SLOW as SLOW,
)
from .equations import (
    by_differences as by_differences,
)
from .equations import (
    by_modulation as by_modulation,
)
from .equations import (
    by_smoothing as by_smoothing,
)
from .equations import (
    repeat as repeat,
)
from .known_axes import (
    FRICTION_TERMS as FRICTION_TERMS,
)
from .known_axes import (
    joint_columns as joint_columns,
)
from .known_axes import (
    joint_terms as joint_terms,
)
from .recursive import (
    RecursiveLeastSquares as RecursiveLeastSquares,
)
from .regression import (
    FRICTION as FRICTION,
)
from .regression import (
    GRAVITY as GRAVITY,
)
from .regression import (
    RIGID as RIGID,
)
from .regression import (
    SIGN_SPEED as SIGN_SPEED,
)
from .regression import (
    Equations as Equations,
)
from .regression import (
    Estimate as Estimate,
)
from .regression import (
    columns as columns,
)
from .regression import (
    excitation as excitation,
)
from .regression import (
    from_states as from_states,
)
from .regression import (
    least_squares as least_squares,
)
from .regression import (
    true_parameters as true_parameters,
)
