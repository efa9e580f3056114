from .actuators import (
    ComputingTime as ComputingTime,
)
from .actuators import (
    DeadZone as DeadZone,
)
from .actuators import (
    FlexibleJoint as FlexibleJoint,
)
from .actuators import (
    Ripple as Ripple,
)
from .actuators import (
    Saturation as Saturation,
)
from .friction import (
    CoulombFriction as CoulombFriction,
)
from .friction import (
    StickSlipFriction as StickSlipFriction,
)
from .friction import (
    StribeckFriction as StribeckFriction,
)
from .friction import (
    ViscousFriction as ViscousFriction,
)
from .real_arm import (
    CMU_DD_ARM_II_EFFECTS as CMU_DD_ARM_II_EFFECTS,
)
from .real_arm import (
    IDEAL as IDEAL,
)
from .real_arm import (
    Backlash as Backlash,
)
from .real_arm import (
    Delay as Delay,
)
from .real_arm import (
    Effects as Effects,
)
from .real_arm import (
    EncoderZero as EncoderZero,
)
from .real_arm import (
    Noise as Noise,
)
from .real_arm import (
    Quantisation as Quantisation,
)
from .real_arm import (
    started as started,
)
