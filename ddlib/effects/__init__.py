"""What Lagrange-Euler leaves out: friction, actuators and sensors, each of which can be off.

- ``friction``: the friction laws: viscous, Coulomb, Stribeck, and stiction (`StickSlipFriction`)
- ``actuators``: saturation, dead zone, ripple, flexible shafts, computing time
- ``real_arm``: `Effects`, all of them in the order in which a signal meets them; the sensors'
  part, where an encoder is rounded (`Quantisation`), noise, delay, backlash; the book's real arm
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    real_arm=(
        "Backlash CMU_DD_ARM_II_EFFECTS Delay Effects EncoderZero IDEAL Noise Quantisation started"
    ),
    friction="CoulombFriction StickSlipFriction StribeckFriction ViscousFriction",
    actuators="ComputingTime DeadZone FlexibleJoint Ripple Saturation",
)
