"""The book's figures: data in, `Illustration` out. No plot detail lives in a chapter.

- ``style``: the figure style: colours, fonts, light and dark, SVG with an alternative text
- ``lines``, ``maps``: curves over one axis, of one network or many; values over a plane
- ``weights``: networks, Hinton diagrams, filters taken apart
- ``dynamics``, ``effects``, ``control``, ``recording``, ``states``: figures of one chapter each
- ``beyond``: figures of Part IV
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    style=(
        "COLOURS DASHES FAINT INK Illustration JOINTS RC check_label illustrate legend_above "
        "plain_ticks"
    ),
    lines="clusters curves families overlay predicted_curves",
    weights="against_nulls decomposition hinton network_diagram",
    dynamics="CENTRED arm_sketch estimates hand_paths operations",
    effects="by_case ranking side_by_side",
    recording="extents_square reached rounding tied",
    maps="COLOUR_MAP intervals plane rmss_by_window",
    states="SYMBOLS error_by_size hinton_states responses torque_along",
    control="feedforward_loop nyquist root_loci",
)
