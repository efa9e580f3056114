"""The paper"s experiments, as this book repeats them: set-ups, studies, committed results."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submodules=["reproduce", "results", "studies", "sweeps"],
    submod_attrs={
        "setups": [
            "COURSE",
            "KD",
            "KP",
            "POSITION_FEEDBACK",
            "SETUPS",
            "STATE_FEEDBACK",
            "Setup",
            "WINDOWS",
            "errors",
            "predict",
            "run",
            "split",
            "train_windows",
        ],
        "states": [
            "EPOCHS",
            "RADIUS",
            "RATE",
            "SAMPLES",
            "random_states",
            "states_along",
            "torque",
        ],
        "random_arms": ["RANGES", "distance", "draw", "setup"],
        "two_harmonics": [
            "ORDER",
            "SHARE",
            "record_two_harmonics",
            "second_amplitudes",
            "true_states",
        ],
    },
)
