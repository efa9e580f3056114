from .coverage import (
    cells_reached as cells_reached,
    inside_hull as inside_hull,
    log10_reachable_share as log10_reachable_share,
    principal_deviations as principal_deviations,
    used_dimensions as used_dimensions,
)
from .excitation import half_penalty as half_penalty, ridge_filters as ridge_filters
from .filters import (
    CLASSES as CLASSES,
    DERIVATIVES as DERIVATIVES,
    basis as basis,
    classify as classify,
    content as content,
    decompose as decompose,
    frequency_response as frequency_response,
    purest as purest,
    roughness as roughness,
    savitzky_golay as savitzky_golay,
    shares as shares,
    upright as upright,
)
from .following import (
    LAYERS as LAYERS,
    QUANTITIES as QUANTITIES,
    explained as explained,
    filter_responses as filter_responses,
    gains as gains,
    mean_gradient as mean_gradient,
)
from .hidden_units import (
    ablation as ablation,
    matched_units as matched_units,
    net_inputs as net_inputs,
    refitted as refitted,
    saturated as saturated,
    transition_width as transition_width,
)
from .noise import (
    acceleration_noise_gain as acceleration_noise_gain,
    noise_floor as noise_floor,
)
from .response import (
    calibrated as calibrated,
    unit_inputs as unit_inputs,
    unit_responses as unit_responses,
)
from .sensitivity import (
    input_shares as input_shares,
    responses as responses,
    shuffled as shuffled,
    transition_centre as transition_centre,
    transition_range as transition_range,
)
from .simplified import (
    linear_residual as linear_residual,
    share_of_other_joint as share_of_other_joint,
    share_of_velocity_terms as share_of_velocity_terms,
)
