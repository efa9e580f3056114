"""What trained weights do, and what data allow: filters, hidden units, coverage, noise."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "filters": [
            "CLASSES",
            "DERIVATIVES",
            "Decomposition",
            "basis",
            "classify",
            "content",
            "decompose",
            "frequency_response",
            "purest",
            "roughness",
            "savitzky_golay",
            "shares",
            "upright",
        ],
        "following": [
            "LAYERS",
            "QUANTITIES",
            "Responses",
            "explained",
            "gains",
            "mean_gradient",
            "summary",
        ],
        "hidden_units": [
            "ablation",
            "cancellation",
            "match",
            "net_inputs",
            "saturated",
            "transition_width",
        ],
        "sensitivity": [
            "INPUTS",
            "input_shares",
            "shuffled",
            "transition_centre",
            "transition_range",
        ],
        "coverage": ["cells_reached", "principal_deviations", "reachable_share", "used_dimensions"],
        "noise": ["acceleration_noise_gain", "noise_floor"],
        "simplified": [
            "OTHER_JOINT",
            "VELOCITY_TERMS",
            "linear_residual",
            "share_of_other_joint",
            "share_of_velocity_terms",
        ],
    },
)
