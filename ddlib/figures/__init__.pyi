from .checked import checked as checked
from .lines import (
    by_case as by_case,
    clouds as clouds,
    curves as curves,
    dots_in_one as dots_in_one,
    families as families,
)
from .loops import poles_and_bode as poles_and_bode
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
    MEANINGS as MEANINGS,
    ROLES as ROLES,
    TONES as TONES,
    Illustration as Illustration,
    check_label as check_label,
    illustrate as illustrate,
    legend_above as legend_above,
    looks as looks,
    plain_ticks as plain_ticks,
)
from .weights import (
    decomposed as decomposed,
    hinton as hinton,
    network_diagram as network_diagram,
    squares as squares,
)
