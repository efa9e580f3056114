"""Recordings from files of one's own: what is read, and what an error names."""

import re

import numpy as np
import pytest

from ddlib.learning import TrainingSet
from ddlib.simulation import read_csv

HEAD = "time,q1,q2,tau1,tau2"
LINES = [f"{0.01 * k:.2f},{k},{k * k},{-k},{2 * k}" for k in range(12)]


def test_runs_come_from_a_column_or_from_files(tmp_path):
    one, other, both = (tmp_path / f"{name}.csv" for name in ("one", "other", "both"))
    one.write_text("\n".join([HEAD, *LINES]))
    other.write_text("\ufeff" + "\r\n".join([HEAD, *LINES[:9]]), "utf-8")
    shuffled = ["tau2, q1,run,note,time,q2,tau1"]
    shuffled += [f"{2 * k},{k},a,x,{5 + 0.01 * k:.2f},{k * k},{-k}" for k in range(12)]
    shuffled += [f"{2 * k},{k},b,,{0.01 * k:.2f},{k * k},{-k}" for k in range(9)]
    both.write_text("\n".join(shuffled))
    k = np.arange(9.0)
    for paths in ([one, other], str(both)):
        recording = read_csv(paths, width=5)
        assert recording.q.shape == (2, 9, 2) and np.isclose(recording.step, 0.01)
        assert (recording.q == np.stack([k, k**2], -1)).all()
        assert (recording.tau == np.stack([-k, 2 * k], -1)).all()
        assert recording.motion == slice(2, 7) and np.isnan(recording.tracking_error).all()
        data = TrainingSet.from_recording(recording, 5)
        assert data.x.shape == (10, 2, 5) and np.isclose(data.step, 0.01)


@pytest.mark.parametrize("head, lines, told", [
    (HEAD.replace("q2", "angle"), LINES, "own.csv, line 1: no column q2 in time, q1, angle"),
    ("", [], "own.csv, line 1: no column time, q1, q2, tau1, tau2 in nothing"),
    (HEAD, [], "own.csv: no samples"),
    (HEAD, [*LINES[:3], "0.03,3,nan,1,1"], "own.csv, line 5, column q2: must be a finite number"),
    (HEAD, [*LINES[:3], "0.03,3,4"], "own.csv, line 5, column tau1: must be a finite number, got"),
    (HEAD, [*LINES[:3], "0.03,3,4,5 Nm,6"], "line 5, column tau1: must be a finite number, got '5"),
    (HEAD, LINES[:5], "own.csv: 5 samples are too few for a window of 5"),
    (HEAD, LINES[:7] + LINES[8:], "line 9: time must grow in equal steps, like the 0.01 s of most"),
    (HEAD, [LINES[0]] * 8, "line 3: time must grow in equal steps"),
    (f"{HEAD},run", [f"{x},a" for x in LINES] + [f"{LINES[0]},b"], "own.csv, run b: 1 samples"),
])  # fmt: skip
def test_errors_name_the_place(head, lines, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.csv").write_text("\n".join([head, *lines]))
    with pytest.raises(ValueError, match=re.escape(told)):
        read_csv("own.csv", width=5)
