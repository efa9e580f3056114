from .actuators import (
    ComputingTime as ComputingTime,
    DeadZone as DeadZone,
    FlexibleJoint as FlexibleJoint,
    Load as Load,
    Ripple as Ripple,
    Saturation as Saturation,
)
from .friction import (
    CoulombFriction as CoulombFriction,
    StickSlipFriction as StickSlipFriction,
    StribeckFriction as StribeckFriction,
    ViscousFriction as ViscousFriction,
)
from .real_arm import (
    CMU_DD_ARM_II_EFFECTS as CMU_DD_ARM_II_EFFECTS,
    IDEAL as IDEAL,
    Backlash as Backlash,
    Delay as Delay,
    Effects as Effects,
    EncoderZero as EncoderZero,
    Noise as Noise,
    Quantisation as Quantisation,
)
