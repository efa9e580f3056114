"""What Lagrange-Euler leaves out: friction, actuators and sensors, each of which can be off."""

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
