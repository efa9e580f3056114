"""Numbers in prose: their units stay with them, and minus is no hyphen."""

from __future__ import annotations

import dd_typography
from dd_typography import MINUS, NO_BREAK, typeset
from docutils import nodes
from docutils.utils import new_document

SET = [  # ~ is a space that does not break, − a minus
    ("0.5 N m and 3 kg m² or 20 %", "0.5~N~m and 3~kg~m² or 20~%"),
    ("5 shoulders, 7 AND 3 meters", "5 shoulders, 7 AND 3 meters"),
    ("1 kg m^2, in rad/s^2, not q^2 or dm^2", "1~kg~m², in rad/s², not q^2 or dm^2"),
    ("from -1 to (-0.5, -2)", "from −1 to (−0.5, −2)"),
    ("CMU-CS-88-160, Table 4-1, 1985-86", "CMU-CS-88-160, Table 4-1, 1985-86"),
]


def test_a_unit_stays_with_its_number_and_minus_is_no_hyphen():
    for text, wanted in SET:
        assert typeset(text) == wanted.replace("~", NO_BREAK).replace("−", MINUS)


def set_pieces(*pieces: nodes.Node) -> str:
    document = new_document("page")
    document += nodes.paragraph("", "", *pieces)
    transform = dd_typography.SetNumbers(document)
    transform.run()
    return document[0].astext()


def test_code_is_as_it_was_written():
    assert set_pieces(nodes.literal("", "x = -1 s"), nodes.Text("-3 s")) == (
        f"x = -1 s-3{NO_BREAK}s"
    )
