from .averaging import (
    encoder_step as encoder_step,
)
from .checking import (
    check_recording as check_recording,
)
from .equations import (
    by_differences as by_differences,
    by_modulation as by_modulation,
    by_smoothing as by_smoothing,
    repeat as repeat,
)
from .known_axes import (
    joint_columns as joint_columns,
    joint_terms as joint_terms,
)
from .recursive import (
    RecursiveLeastSquares as RecursiveLeastSquares,
)
from .regression import (
    FRICTION as FRICTION,
    GRAVITY as GRAVITY,
    OFFSETS as OFFSETS,
    RIGID as RIGID,
    SIGN_SPEED as SIGN_SPEED,
    SLOW as SLOW,
    Combination as Combination,
    Equations as Equations,
    Estimate as Estimate,
    ImpossibleArm as ImpossibleArm,
    excitation as excitation,
    from_states as from_states,
    least_squares as least_squares,
    true_parameters as true_parameters,
)
from .smoothers import (
    butterworth_states as butterworth_states,
    kalman_states as kalman_states,
)
from .window_filters import (
    FilteredEquations as FilteredEquations,
)
