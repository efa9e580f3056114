"""Arm, controller and sensors run together, each at its own rate: recordings."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "recording": ["Recording", "equal_steps"],
        "plant": ["PHASE", "Plant", "substeps"],
        "simulate": ["CONTROL_STEP", "LOG_STEP", "REST", "follow", "free_motion", "record"],
        "loops": [
            "Load",
            "Response",
            "SecondOrderModel",
            "fast_pick_and_place",
            "feedforward_system",
            "predicted_response",
            "run_system",
            "score",
            "simulated_response",
            "smooth_pick_and_place",
        ],
        "residual": ["residual_torque", "rms"],
    },
)
