"""The ledger's picture says what it shows and refuses what it cannot show."""

import pytest
from pictures import words

from workshop.chapters.verdict import verdicts

COUNTS = {"1. One": {"yes": 3, "no": 0}, "2. Two": {"yes": 1, "no": 2}}


def test_every_number_is_in_the_words_and_in_the_picture():
    figure = verdicts(COUNTS)
    assert "1. One: 3 yes; 2. Two: 1 yes, 2 no." in figure.alt
    assert figure.alt in figure.svg
    texts = set(words(figure))
    assert {"1. One", "2. Two", "yes", "no", "1", "2", "3"} <= texts


def test_no_counts():
    with pytest.raises(ValueError, match="counts must hold one section or more"):
        verdicts({})
