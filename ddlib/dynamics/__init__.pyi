from .arm import (
    CMU_DD_ARM_II as CMU_DD_ARM_II,
)
from .arm import (
    IMI_ARM as IMI_ARM,
)
from .arm import (
    REYES_KELLY_ARM as REYES_KELLY_ARM,
)
from .arm import (
    STANDARD_GRAVITY as STANDARD_GRAVITY,
)
from .arm import (
    Arm as Arm,
)
from .arm import (
    Link as Link,
)
from .arm import (
    with_load as with_load,
)
from .costs import (
    count as count,
)
from .costs import (
    table as table,
)
from .counting import (
    Operations as Operations,
)
from .counting import (
    Tape as Tape,
)
from .derivation import (
    derive as derive,
)
from .formulations import (
    lagrange_euler as lagrange_euler,
)
from .formulations import (
    newton_euler as newton_euler,
)
from .formulations import (
    recursive_lagrange as recursive_lagrange,
)
from .joints import (
    DD_ARM_II_IN_SPACE as DD_ARM_II_IN_SPACE,
)
from .joints import (
    hand as hand,
)
from .joints import (
    inertial_parameters as inertial_parameters,
)
from .joints import (
    locked as locked,
)
from .joints import (
    mass_matrix as mass_matrix,
)
from .joints import (
    regressor as regressor,
)
from .kinematics import (
    ELBOWS as ELBOWS,
)
from .kinematics import (
    Unreachable as Unreachable,
)
from .kinematics import (
    around as around,
)
from .kinematics import (
    end_point_error as end_point_error,
)
from .kinematics import (
    follow_hand as follow_hand,
)
from .kinematics import (
    inverse_kinematics as inverse_kinematics,
)
from .kinematics import (
    jacobian as jacobian,
)
from .kinematics import (
    reach as reach,
)
from .serial import (
    PUMA_560 as PUMA_560,
)
from .serial import (
    PUMA_560_GEARS as PUMA_560_GEARS,
)
from .serial import (
    PUMA_560_ROTORS as PUMA_560_ROTORS,
)
from .serial import (
    SerialArm as SerialArm,
)
from .serial import (
    SpatialLink as SpatialLink,
)
