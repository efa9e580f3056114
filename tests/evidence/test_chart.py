"""The ledger's picture says what it shows and refuses what it cannot show."""

import pytest
from pictures import words

from ddlib.evidence.chart import verdicts

COUNTS = {"1. One": {"yes": 3, "no": 0}, "2. Two": {"yes": 1, "no": 2}}


def test_every_number_is_in_the_words_and_in_the_picture():
    figure = verdicts(COUNTS)
    assert "1. One: 3 yes; 2. Two: 1 yes, 2 no." in figure.alt
    assert figure.alt in figure.svg
    texts = set(words(figure))
    assert {"1. One", "2. Two", "yes", "no", "1", "2", "3"} <= texts


@pytest.mark.parametrize(
    "counts, message",
    [
        ({}, "counts must hold one section or more"),
        ({"1": dict.fromkeys("abcdefg", 1)}, "at most 6 verdicts, got 7"),
        ({"1": {"yes": 1}, "2": {"no": 1}}, r"must have the verdicts \['yes'\] in '2', got"),
        ({"1": {"yes": -1}}, "counts of '1' must"),
    ],
)
def test_bad_counts(counts, message):
    with pytest.raises(ValueError, match=message):
        verdicts(counts)


def test_numbers_must_be_whole():
    with pytest.raises(TypeError, match="counts of '1' must"):
        verdicts({"1": {"yes": 1.5}})
