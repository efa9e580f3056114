from .arm import (
    CMU_DD_ARM_II as CMU_DD_ARM_II,
    IMI_ARM as IMI_ARM,
    REYES_KELLY_ARM as REYES_KELLY_ARM,
    STANDARD_GRAVITY as STANDARD_GRAVITY,
    Arm as Arm,
    Link as Link,
    with_load as with_load,
)
from .costs import (
    count_operations as count_operations,
    operations_table as operations_table,
)
from .counting import (
    Operations as Operations,
    Tape as Tape,
)
from .derivation import (
    derive as derive,
)
from .formulations import (
    lagrange_euler as lagrange_euler,
    newton_euler as newton_euler,
    recursive_lagrange as recursive_lagrange,
)
from .joints import (
    DD_ARM_II_IN_SPACE as DD_ARM_II_IN_SPACE,
    locked as locked,
    mass_matrix as mass_matrix,
    regressor as regressor,
)
from .kinematics import (
    ELBOWS as ELBOWS,
    Unreachable as Unreachable,
    end_point_error as end_point_error,
    follow_hand as follow_hand,
    inverse_kinematics as inverse_kinematics,
    jacobian as jacobian,
    reach as reach,
)
from .second_order import (
    SecondOrderModel as SecondOrderModel,
)
from .serial import (
    PUMA_560 as PUMA_560,
    PUMA_560_GEARS as PUMA_560_GEARS,
    PUMA_560_ROTORS as PUMA_560_ROTORS,
    SerialArm as SerialArm,
    SpatialLink as SpatialLink,
)
