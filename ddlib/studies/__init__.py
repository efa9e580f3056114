"""What is too slow for a chapter: the studies that ``make reproduce`` repeats.

Every study is a function without required arguments that returns a plain dictionary.
"""

from __future__ import annotations

from collections.abc import Callable

from ddlib.studies import state_space, table, windows

PARTS: dict[str, Callable[[], dict]] = {
    "table-4-1": table.table_4_1,
    "gains": table.gains,
    "longer": table.longer,
    "clean": table.clean,
    "window-sizes": windows.window_sizes,
    "hidden-units": windows.hidden_units,
    "memory": windows.memory,
    "table-6-1": state_space.table_6_1,
    "state-space-choices": state_space.state_space_choices,
}
"""The studies by the name of their result."""
