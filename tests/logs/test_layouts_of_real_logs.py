"""Layouts that logs in public repositories have, each reduced to what made it hard."""

import numpy as np
import pytest

from ddlib.logs import read_csv, read_log

ANGLES = np.array([[0.1, -0.2], [0.2, -0.15], [0.35, 0.0], [0.4, 0.1], [0.38, 0.3]])


def write(path, *lines):
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def rows(times, angles=ANGLES):
    """Lines of a log whose torques do not matter."""
    return [f"{t},{a},{b},.1,.2" for t, (a, b) in zip(times, angles)]


def lines(form, end="", angles=ANGLES):
    """Lines with a time in ms, angles in degrees, and torques."""
    return [form.format(10 * k, *np.rad2deg(q), 0.5, -k) + end for k, q in enumerate(angles)]


POINTS, TABS = "{:.3f} {:.6f} {:.6f} {:.6f} {:.6f}", "{:d}\t{:.6f}\t{:.6f}\t{:.6f}\t{:.6f}"
ALIKE = {
    "MATLAB": [
        "% 12-May-2024 10:11:12, Fs = 100 Hz", "%  time  q1   q2   tau1  tau2",
        "%  ms    deg  deg  N m   N m", *lines("   " + POINTS.replace(" ", "   ")),
    ],
    "rostopic echo -p": [
        "%time,field.header.frame_id,field.name0,field.q1 [deg],field.q2 [deg],tau1,tau2",
        *lines("17000000000{:02d}000000,,shoulder,{:.6f},{:.6f},{},{}"),
    ],
    "Excel": [
        "\ufeffsep=;", "Time [ms];Q1 [°];Q2 [°];Tau1 [Nm];Tau2 [Nm]" + 3000 * ";",
        *(x.replace(".", ",") for x in lines(TABS.replace("\t", ";"), 3000 * ";")),
        *([3004 * ";"] * 2000),
    ],
    "LabVIEW": [
        "LabVIEW Measurement\t", "***End_of_Header***", "Samples\t5\t5\t5\t5",
        "Delta_X\t10.0\t10.0\t10.0\t10.0", "time_ms\tq1_deg\tq2_deg\ttau1\ttau2\tComment",
        lines(TABS)[0] + "\tbegun by hand", *lines(TABS)[1:],
    ],
    "columns of a fixed width": [
        " time      q1        q2       tau1     tau2", " [ms]     [deg]    [deg]     [Nm]     [Nm]",
        50 * "-", *lines("{:6d}  {:8.5f}  {:8.5f}  {:8.5f} {:8.5f}"),
    ],
    "a passive column": [
        "time_ms;q1/deg;q2/deg;temperature;tau1;tau2;state",
        *(x.replace(" ", ";").replace("0.500000;", "nan;0.5;") + ";" for x in lines(POINTS)),
    ],
}  # fmt: skip


@pytest.mark.parametrize("kind", ALIKE)
def test_exports_of_other_programs(kind, tmp_path):
    path = write(tmp_path / "log.txt", *ALIKE[kind])
    heads = {"q1": "field.q1", "q2": "field.q2"} if kind.startswith("ros") else {}
    (run,) = read_log(path, heads).runs
    np.testing.assert_allclose(run.q, ANGLES, atol=1e-6)
    np.testing.assert_allclose(run.tau, np.stack([np.full(5, 0.5), -np.arange(5)], -1))
    np.testing.assert_allclose(run.t, 0.01 * np.arange(5), atol=1e-9)


def comma(x):
    return f"{1000 * x:.6f}E-3".replace(".", ",")


def test_heads_below_lines_about_the_log(tmp_path):
    # a Pendubot of a teaching laboratory: a date, a blank line, heads, tabs, a tab at each end,
    # decimal commas with exponents of three, and a time that counts samples
    lines = [
        "\t".join([str(k), comma(a), comma(b), comma(0.25), ""]) for k, (a, b) in enumerate(ANGLES)
    ]
    about = "vendredi 12 décembre 2025\t17:15:10\tSampling Period : 4  ms\t\tOpen Loop"
    path = write(tmp_path / "log.txt", about, "", "t\tAlpha1\tAlpha2\tCurr_Monitor", *lines)
    names = {"time": "t", "q1": "Alpha1", "q2": "Alpha2", "tau1": "Curr_Monitor", "tau2": None}
    with pytest.raises(ValueError, match=r'steps of 1 may be .* say which by units=\{"time"'):
        read_log(path, names)
    recording = read_csv(path, names, {"time": 0.004, "tau1": "A"}, {"tau1": 0.1})
    np.testing.assert_allclose(recording.q[0], ANGLES, rtol=0, atol=1e-9)
    np.testing.assert_allclose(recording.tau[0], [[0.025, 0.0]] * 5, rtol=1e-12)
    np.testing.assert_allclose(recording.t, 0.004 * np.arange(5), rtol=1e-12)
    assert any("above the heads" in note for note in recording.notes)


@pytest.mark.parametrize("first", [0.5, 0.0])
def test_a_time_that_begins_again_begins_a_run(tmp_path, first):
    # runs of a motor, appended to one file by its logger
    time = 0.005 * np.arange(5)
    two = rows(first + time) + rows(time, -ANGLES)
    path = write(tmp_path / "log.csv", "time,q1,q2,tau1,tau2", *two)
    recording = read_csv(path)
    assert recording.names == (f"{path}, run 1", f"{path}, run 2")
    assert any("begins again at 1 place, the first at line 7" in x for x in recording.notes)
    np.testing.assert_array_equal(recording.q, [ANGLES, -ANGLES])


@pytest.mark.parametrize("first, step, unit, seconds", [
    (1_210_441_551, 12, "ms", 0.012),  # a KUKA's counter, which looks like seconds since 1970
    (1_700_000_000, 3.5, "s", 3.5),  # seconds since 1970, of a slow log
])  # fmt: skip
def test_a_clock_in_doubt_is_asked_about(tmp_path, first, step, unit, seconds):
    path = write(tmp_path / "log.csv", "IPOC,q1,q2,tau1,tau2", *rows(first + step * np.arange(5)))
    with pytest.raises(ValueError, match=r'column IPOC: steps of \S+ may be "s" .* or "ms"'):
        read_log(path, {"time": "IPOC"})
    recording = read_csv(path, {"time": "IPOC"}, {"time": unit})
    assert recording.step == pytest.approx(seconds, rel=1e-6)


def test_a_log_of_one_joint(tmp_path):
    lines = [f"{0.005 * k:.3f},{a},.{k}" for k, a in enumerate(ANGLES[:, 0])]
    path = write(tmp_path / "log.csv", "time,position,torque", *lines)
    names = {"q1": "position", "tau1": "torque", "q2": None, "tau2": None}
    recording = read_csv(path, names)
    np.testing.assert_array_equal(recording.q[0], ANGLES * [1, 0])
    assert any("q2 is taken to be 0" in note for note in recording.notes)
