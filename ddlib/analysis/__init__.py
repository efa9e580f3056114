"""What trained weights do, and what data allow: filters, hidden units, coverage, noise.

- ``filters``: weights as convolution filters: their parts, derivatives, names, gains
- ``following``: which motion the outputs of filters follow along a recording
- ``response``: what units and networks respond to, in signals and in physical units; probes
- ``hidden_units``: saturation, ablation, cancellation, refitting, units matched between networks
- ``sensitivity``: which inputs and ranges a network of states responds to
- ``coverage``, ``overlap``: what samples reach, and whether others reach the same
- ``noise``: the error that sensors leave to anybody
- ``simplified``: what simpler models of the arm lose
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    filters=(
        "CLASSES DERIVATIVES Decomposition basis classify content decompose frequency_response "
        "pure_part purest roughness savitzky_golay shares upright"
    ),
    following="followed LAYERS QUANTITIES Responses explained gains mean_gradient summary",
    hidden_units=(
        "ablation cancellation match net_inputs refitted saturated transition_width with_filters"
    ),
    response="calibrated Calibrated decoded decoded_sign heard unit_inputs with_jerk",
    sensitivity="responses INPUTS input_shares shuffled transition_centre transition_range",
    coverage="cells_reached principal_deviations log10_reachable_share used_dimensions",
    overlap="nearest_distances shared_cells",
    noise="acceleration_noise_gain noise_floor",
    simplified=(
        "OTHER_JOINT VELOCITY_TERMS linear_residual share_of_other_joint share_of_velocity_terms"
    ),
)
