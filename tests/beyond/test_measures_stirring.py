"""Whether pick-and-place turns once: on Appendix I itself, and on motions that turn twice."""

import numpy as np

from workshop.beyond.measures.loop import stirring


def test_appendix_i_turns_once(monkeypatch):
    assert stirring.turns().value is True
    twice = lambda extents, t: type("", (), {"qd": np.sin(6 * t)[:, None] * np.ones((6, 1, 2))})  # noqa: E731
    monkeypatch.setattr(stirring, "pick_and_place", twice)
    assert stirring.turns().value is False
