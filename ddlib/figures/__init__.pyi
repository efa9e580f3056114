from .control import (
    feedforward_loop as feedforward_loop,
)
from .control import (
    nyquist as nyquist,
)
from .control import (
    root_loci as root_loci,
)
from .dynamics import (
    CENTRED as CENTRED,
)
from .dynamics import (
    arm_sketch as arm_sketch,
)
from .dynamics import (
    estimates as estimates,
)
from .dynamics import (
    hand_paths as hand_paths,
)
from .dynamics import (
    operations as operations,
)
from .effects import (
    by_case as by_case,
)
from .effects import (
    ranking as ranking,
)
from .effects import (
    side_by_side as side_by_side,
)
from .lines import (
    clusters as clusters,
)
from .lines import (
    curves as curves,
)
from .lines import (
    families as families,
)
from .lines import (
    overlay as overlay,
)
from .lines import (
    predicted_curves as predicted_curves,
)
from .maps import (
    COLOUR_MAP as COLOUR_MAP,
)
from .maps import (
    intervals as intervals,
)
from .maps import (
    plane as plane,
)
from .maps import (
    rmss_by_window as rmss_by_window,
)
from .recording import (
    extents_square as extents_square,
)
from .recording import (
    reached as reached,
)
from .recording import (
    rounding as rounding,
)
from .recording import (
    tied as tied,
)
from .states import (
    SYMBOLS as SYMBOLS,
)
from .states import (
    error_by_size as error_by_size,
)
from .states import (
    hinton_states as hinton_states,
)
from .states import (
    responses as responses,
)
from .states import (
    torque_along as torque_along,
)
from .style import (
    COLOURS as COLOURS,
)
from .style import (
    DASHES as DASHES,
)
from .style import (
    FAINT as FAINT,
)
from .style import (
    INK as INK,
)
from .style import (
    JOINTS as JOINTS,
)
from .style import (
    RC as RC,
)
from .style import (
    Illustration as Illustration,
)
from .style import (
    check_label as check_label,
)
from .style import (
    illustrate as illustrate,
)
from .style import (
    legend_above as legend_above,
)
from .style import (
    plain_ticks as plain_ticks,
)
from .weights import (
    against_nulls as against_nulls,
)
from .weights import (
    decomposition as decomposition,
)
from .weights import (
    hinton as hinton,
)
from .weights import (
    network_diagram as network_diagram,
)
