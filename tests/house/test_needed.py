"""The cells that a notebook's widgets need."""

from needed import needed

CELLS = [
    "import numpy as np\nfrom ddlib.widgets import Player",
    "a = np.ones(3)",
    "b = 2 * a\nprint(b)",
    "%config InlineBackend.figure_formats = ['svg']\nunused = a",
    "b[0] = 5",
    "Player(b)",
    "after = b",
]


def test_the_cells_before_a_widget_that_give_its_names():
    assert needed(CELLS) == [0, 1, 2, 4, 5]
    assert needed(["from ddlib import widgets", "1", "widgets.Player()"]) == [0, 2]
    assert needed(["Player = 1", "Player + 1"]) == []
