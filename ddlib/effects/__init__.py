"""What Lagrange-Euler leaves out: friction, actuators and sensors, each of which can be off.

- ``friction``: the friction laws, viscous, Coulomb, Stribeck, and one that sticks
- ``actuators``: saturation, dead zone, ripple, flexible shafts, computing time
- ``real_arm``: `Effects`, all of them in the order in which a signal meets them; the sensors'
  part, where an encoder is rounded (`Quantisation`), noise, delay, backlash; the book's real arm
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "real_arm": [
            "Backlash",
            "CMU_DD_ARM_II_EFFECTS",
            "Delay",
            "Effects",
            "IDEAL",
            "Noise",
            "Quantisation",
            "started",
        ],
        "friction": ["CoulombFriction", "StickSlipFriction", "StribeckFriction", "ViscousFriction"],
        "actuators": ["ComputingTime", "DeadZone", "FlexibleJoint", "Ripple", "Saturation"],
    },
)
