"""Layouts that logs in public repositories have, each reduced to what made it hard."""

import numpy as np
import pytest

from ddlib.logs import read_csv, read_log

ANGLES = np.array([[0.1, -0.2], [0.2, -0.15], [0.35, 0.0], [0.4, 0.1], [0.38, 0.3]])


def write(path, lines):
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def comma(x):
    return f"{1000 * x:.6f}E-3".replace(".", ",")


def test_heads_below_lines_about_the_log(tmp_path):
    # a Pendubot of a teaching laboratory: a date, a blank line, heads, tabs, a tab at each end,
    # decimal commas with exponents of three, and a time that counts samples
    rows = ["\t".join([str(k), comma(a), comma(b), comma(0.25), ""]) for k, (a, b) in
            enumerate(ANGLES)]  # fmt: skip
    about = ["vendredi 12 décembre 2025\t17:15:10\tSampling Period : 4  ms\t\tOpen Loop", ""]
    path = write(tmp_path / "log.txt", [*about, "t\tAlpha1\tAlpha2\tCurr_Monitor", *rows])
    names = {"time": "t", "q1": "Alpha1", "q2": "Alpha2", "tau1": "Curr_Monitor", "tau2": None}
    with pytest.raises(ValueError, match=r'steps of 1 may be .* say which by units=\{"time"'):
        read_log(path, names)
    recording = read_csv(path, names, {"time": 0.004, "tau1": "A"}, {"tau1": 0.1})
    np.testing.assert_allclose(recording.q[0], ANGLES, rtol=0, atol=1e-9)
    np.testing.assert_allclose(recording.tau[0], [[0.025, 0.0]] * 5, rtol=1e-12)
    np.testing.assert_allclose(recording.t, 0.004 * np.arange(5), rtol=1e-12)
    assert any("above the heads" in note for note in recording.notes)


def test_lines_about_the_log_do_not_hide_a_wrong_count_of_cells(tmp_path):
    rows = [f"{0.01 * k:.2f},{a},{b},1.5,-.5,9" for k, (a, b) in enumerate(ANGLES)]
    path = write(tmp_path / "log.csv", ["time,q1,q2,tau1,tau2", *rows])
    with pytest.raises(ValueError, match="line 2: 6 cells under 5 heads"):
        read_log(path)


@pytest.mark.parametrize("first", [0.5, 0.0])
def test_a_time_that_begins_again_begins_a_run(tmp_path, first):
    # runs of a motor, appended to one file by its logger
    def lines(start, angles):
        return [f"{start + 0.005 * k:.3f},{a},{b},.1,.2" for k, (a, b) in enumerate(angles)]

    two = lines(first, ANGLES) + lines(0.0, -ANGLES)
    path = write(tmp_path / "log.csv", ["time,q1,q2,tau1,tau2", *two])
    log = read_log(path)
    assert [run.name for run in log.runs] == [f"{path}, run 1", f"{path}, run 2"]
    assert any("begins again at 1 places, the first at line 7" in note for note in log.notes)
    recording = read_csv(path)
    np.testing.assert_array_equal(recording.q, [ANGLES, -ANGLES])


def test_a_time_that_jumps_back_a_little_is_refused(tmp_path):
    stamps = (0.0, 0.01, 0.02, 0.03, 0.025, 0.04)
    rows = [f"{t},{a},{b},.1,.2" for t, (a, b) in zip(stamps, [*ANGLES, ANGLES[0]])]
    path = write(tmp_path / "log.csv", ["time,q1,q2,tau1,tau2", *rows])
    with pytest.raises(ValueError, match=r"line 6: time must grow, but 0\.03 s is followed"):
        read_csv(path)


@pytest.mark.parametrize(
    "first, step, unit, seconds",
    [
        (1_210_441_551, 12, "ms", 0.012),  # a KUKA's counter, which looks like seconds since 1970
        (1_700_000_000, 3.5, "s", 3.5),  # seconds since 1970, of a slow log
    ],
)
def test_a_clock_in_doubt_is_asked_about(tmp_path, first, step, unit, seconds):
    rows = [f"{first + step * k},{a},{b},.1,.2" for k, (a, b) in enumerate(ANGLES)]
    path = write(tmp_path / "log.csv", ["IPOC,q1,q2,tau1,tau2", *rows])
    with pytest.raises(ValueError, match=r'column IPOC: steps of \S+ may be "s" .* or "ms"'):
        read_log(path, {"time": "IPOC"})
    recording = read_csv(path, {"time": "IPOC"}, {"time": unit})
    assert recording.step == pytest.approx(seconds, rel=1e-6)


def test_a_clock_that_leaves_no_doubt_is_not_asked_about(tmp_path):
    rows = [f"{1681917731 + 0.0025 * k:.4f},{a},{b},.1,.2" for k, (a, b) in enumerate(ANGLES)]
    path = write(tmp_path / "log.csv", ["time,q1,q2,tau1,tau2", *rows])
    assert read_csv(path).step == pytest.approx(0.0025, rel=1e-4)


def test_a_log_of_one_joint(tmp_path):
    rows = [f"{0.005 * k:.3f},{a},.{k}" for k, a in enumerate(ANGLES[:, 0])]
    path = write(tmp_path / "log.csv", ["time,position,torque", *rows])
    names = {"q1": "position", "tau1": "torque"}
    recording = read_csv(path, {**names, "q2": None, "tau2": None})
    np.testing.assert_array_equal(recording.q[0], ANGLES * [1, 0])
    assert any("q2 is taken to be 0" in note for note in recording.notes)
    with pytest.raises(
        ValueError, match="columns: q1 must be a head of the file or a place, got None"
    ):
        read_csv(path, {**names, "q1": None, "q2": None, "tau2": None})


def test_one_number_on_a_line(tmp_path):
    path = write(tmp_path / "torques.txt", [str(x) for x in ANGLES.ravel()])
    with pytest.raises(ValueError, match="one number on a line; a log must have a line for each"):
        read_log(path)


def test_angles_and_torques_in_two_files(tmp_path):
    rows = [f"{0.005 * k:.3f},{a},{b}" for k, (a, b) in enumerate(ANGLES)]
    path = write(tmp_path / "positions.csv", ["time,joint_1,joint_2", *rows])
    same = {"q1": "joint_1", "q2": "joint_2", "tau1": "joint_1", "tau2": "joint_2"}
    with pytest.raises(ValueError, match=r"q1 and tau1 must differ.*join files of angles"):
        read_log([path, path], same)
