from .checked import checked as checked
from .lines import (
    by_case as by_case,
    curves as curves,
    dots_in_one as dots_in_one,
    families as families,
)
from .many import gallery as gallery, readings as readings
from .maps import (
    COLOUR_MAP as COLOUR_MAP,
    rmss_by_window as rmss_by_window,
)
from .style import (
    COLOURS as COLOURS,
    DASHES as DASHES,
    FAINT as FAINT,
    INK as INK,
    JOINTS as JOINTS,
    ROLES as ROLES,
    TONES as TONES,
    Illustration as Illustration,
    check_label as check_label,
    illustrate as illustrate,
    legend_above as legend_above,
    plain_ticks as plain_ticks,
)
from .weights import (
    decomposed as decomposed,
    hinton as hinton,
    network_diagram as network_diagram,
)
