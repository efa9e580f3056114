"""The book"s figures: data in, `Illustration` out. No plot detail lives in a chapter."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "style": [
            "COLOURS",
            "DASHES",
            "FAINT",
            "INK",
            "Illustration",
            "RC",
            "check_label",
            "illustrate",
            "legend_above",
            "plain_ticks",
        ],
        "weights": [
            "arm_sketch",
            "curves",
            "decomposition",
            "extents_square",
            "hinton",
            "network_diagram",
            "overlay",
            "rmss_by_window",
            "share_map",
        ],
        "learning": ["clusters", "families"],
        "dynamics": ["CENTRED", "estimates", "hand_paths", "operations"],
        "effects": ["by_case", "ranking", "side_by_side"],
        "recording": ["reached", "rounding", "tied"],
        "maps": ["COLOUR_MAP", "plane", "scatter"],
        "states": ["SYMBOLS", "error_by_size", "hinton_states", "responses", "torque_along"],
        "control": ["root_loci"],
        "diagrams": ["feedforward_loop"],
    },
)
