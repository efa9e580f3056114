"""Tables of known torques and written loads, and rows of the joints that the report names."""

import numpy as np
import pytest

from ddlib.analysis import classify
from workshop.chapters import convolution_filters, planted
from workshop.report import results


def cells(table):
    return {row[0]: row[1:] for row in table.rows}


def test_the_table_of_torques_has_the_means_of_single_networks():
    shown = cells(planted.known_torques())
    for name, kind in planted.of_kinds().items():
        label = name.replace(" along", ",").replace("the arm", "this arm")
        _, own, read, knob, *_ = shown[label]
        told = [float(text.replace("−", "-").split()[0]) for text in (own, read, knob)]
        means = [
            kind["truth"][0][0][2],
            *(np.mean(planted.every(name, x)) for x in ("M11", "knob")),
        ]
        assert told == pytest.approx(means, abs=0.051)
        assert told[2] == pytest.approx(means[2], abs=6e-4)


def test_a_short_window_reads_little_and_a_written_load_helps():
    short, middle, _ = cells(planted.by_window())["joint damping, 4,000 epochs"]
    assert float(short.split(",")[0]) < 0.6 < 1.0 < float(middle.split(",")[0])
    trained, written, *_, opposite = (
        float(cell.split(",")[0]) for cell in cells(planted.written_loads())["3 kg"]
    )
    assert written < trained / 3 and opposite > 1.5 * trained


def test_rows_of_the_five_figures_weight_the_joint_that_the_report_names():
    for (label, f), joint in zip(convolution_filters.panels().items(), (1, 0, 1, 1, 0)):
        rows = results.networks(f.size).weights.hidden_weights[..., joint, :].reshape(-1, f.size)
        assert (np.abs(rows) == np.abs(f)).all(-1).any(), label
        assert label.endswith(("shoulder", "elbow")[joint])
    velocity, acceleration, *_ = convolution_filters.reported().values()
    assert [str(classify(f)) for f in (velocity, acceleration)] == ["velocity", "acceleration"]
