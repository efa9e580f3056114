from .control import (
    feedforward_loop as feedforward_loop,
    nyquist as nyquist,
    root_loci as root_loci,
)
from .dynamics import (
    CENTRED as CENTRED,
    arm_sketch as arm_sketch,
    estimates as estimates,
    hand_paths as hand_paths,
    operations as operations,
)
from .effects import (
    by_case as by_case,
    ranking as ranking,
    side_by_side as side_by_side,
)
from .lines import (
    clusters as clusters,
    curves as curves,
    families as families,
    overlay as overlay,
    predicted_curves as predicted_curves,
)
from .maps import (
    COLOUR_MAP as COLOUR_MAP,
    intervals as intervals,
    plane as plane,
    rmss_by_window as rmss_by_window,
)
from .recording import (
    extents_square as extents_square,
    reached as reached,
    rounding as rounding,
    tied as tied,
)
from .states import (
    SYMBOLS as SYMBOLS,
    error_by_size as error_by_size,
    hinton_states as hinton_states,
    responses as responses,
    torque_along as torque_along,
)
from .style import (
    COLOURS as COLOURS,
    DASHES as DASHES,
    FAINT as FAINT,
    INK as INK,
    JOINTS as JOINTS,
    RC as RC,
    Illustration as Illustration,
    check_label as check_label,
    illustrate as illustrate,
    legend_above as legend_above,
    plain_ticks as plain_ticks,
)
from .weights import (
    against_nulls as against_nulls,
    decomposition as decomposition,
    hinton as hinton,
    network_diagram as network_diagram,
)
