from .coverage import (
    cells_reached as cells_reached,
)
from .coverage import (
    log10_reachable_share as log10_reachable_share,
)
from .coverage import (
    principal_deviations as principal_deviations,
)
from .coverage import (
    used_dimensions as used_dimensions,
)
from .filters import (
    CLASSES as CLASSES,
)
from .filters import (
    DERIVATIVES as DERIVATIVES,
)
from .filters import (
    Decomposition as Decomposition,
)
from .filters import (
    basis as basis,
)
from .filters import (
    classify as classify,
)
from .filters import (
    content as content,
)
from .filters import (
    decompose as decompose,
)
from .filters import (
    frequency_response as frequency_response,
)
from .filters import (
    pure_part as pure_part,
)
from .filters import (
    purest as purest,
)
from .filters import (
    roughness as roughness,
)
from .filters import (
    savitzky_golay as savitzky_golay,
)
from .filters import (
    shares as shares,
)
from .filters import (
    upright as upright,
)
from .following import (
    LAYERS as LAYERS,
)
from .following import (
    QUANTITIES as QUANTITIES,
)
from .following import (
    Responses as Responses,
)
from .following import (
    explained as explained,
)
from .following import (
    followed as followed,
)
from .following import (
    gains as gains,
)
from .following import (
    mean_gradient as mean_gradient,
)
from .following import (
    summary as summary,
)
from .hidden_units import (
    ablation as ablation,
)
from .hidden_units import (
    cancellation as cancellation,
)
from .hidden_units import (
    match as match,
)
from .hidden_units import (
    net_inputs as net_inputs,
)
from .hidden_units import (
    refitted as refitted,
)
from .hidden_units import (
    saturated as saturated,
)
from .hidden_units import (
    transition_width as transition_width,
)
from .hidden_units import (
    with_filters as with_filters,
)
from .noise import (
    acceleration_noise_gain as acceleration_noise_gain,
)
from .noise import (
    noise_floor as noise_floor,
)
from .overlap import (
    nearest_distances as nearest_distances,
)
from .overlap import (
    shared_cells as shared_cells,
)
from .response import (
    Calibrated as Calibrated,
)
from .response import (
    calibrated as calibrated,
)
from .response import (
    decoded as decoded,
)
from .response import (
    decoded_sign as decoded_sign,
)
from .response import (
    heard as heard,
)
from .response import (
    unit_inputs as unit_inputs,
)
from .response import (
    with_jerk as with_jerk,
)
from .sensitivity import (
    INPUTS as INPUTS,
)
from .sensitivity import (
    input_shares as input_shares,
)
from .sensitivity import (
    responses as responses,
)
from .sensitivity import (
    shuffled as shuffled,
)
from .sensitivity import (
    transition_centre as transition_centre,
)
from .sensitivity import (
    transition_range as transition_range,
)
from .simplified import (
    OTHER_JOINT as OTHER_JOINT,
)
from .simplified import (
    VELOCITY_TERMS as VELOCITY_TERMS,
)
from .simplified import (
    linear_residual as linear_residual,
)
from .simplified import (
    share_of_other_joint as share_of_other_joint,
)
from .simplified import (
    share_of_velocity_terms as share_of_velocity_terms,
)
