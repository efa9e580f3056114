"""The printed numbers, typed a second time from the report, and what the text says of them."""

from ddlib import paper


def test_appendix_i_as_printed():
    shoulder = [45.0, 38.6, 5.4, 20.9, 0.0, 39.5]
    elbow = [45.0, 32.2, 39.4, 0.0, 45.0, 14.4]
    assert list(paper.APPENDIX_I_EXTENTS_DEG) == list(zip(shoulder, elbow))
    assert paper.TRAINING_TRAJECTORIES == (1, 2, 3, 4, 5) and paper.TEST_TRAJECTORY == 6
    assert paper.SAMPLES_PER_TRAJECTORY == 3 * 100  # three seconds, 100 samples per second


def test_tables_as_printed():
    printed = [(w, *paper.TABLE_4_1[w]) for w in sorted(paper.TABLE_4_1)]
    assert printed == [(11, 0.078, 0.22), (21, 0.027, 0.10), (41, 0.024, 0.13)]
    printed = {"random set A": 0.068, "random set B": 0.083, "trajectory 6": 0.067}
    assert dict(paper.TABLE_6_1) == printed
    assert dict(paper.LARGEST_WEIGHT) == {11: 18.9, 21: 11.7, 41: 4.2}


def test_table_4_1_says_what_the_text_says():
    """Sections 4 and 5.3: training improves with the window, the test is best at 21."""
    rows = [paper.TABLE_4_1[w] for w in (11, 21, 41)]
    assert rows[0].training > rows[1].training > rows[2].training
    assert min(paper.TABLE_4_1, key=lambda w: paper.TABLE_4_1[w].test) == 21
    assert all(row.test > row.training for row in rows)
