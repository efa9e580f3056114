"""Logs of one's own arm: one known motion in many formats, and what errors say of the others."""

import gzip
import re
import subprocess
import sys
import time

import numpy as np
import pytest

from ddlib.logs import LoggedRecording, read_csv, read_log, write_csv
from ddlib.simulation import Recording
from ddlib.trajectories import Trajectory

HEAD = "time,q1,q2,tau1,tau2"
SAMPLES = 60
K = np.arange(SAMPLES)
TIME = 0.01 * K
Q = np.stack([0.5 * np.sin(0.13 * K), 0.9 + 0.3 * np.cos(0.2 * K)], -1)
TAU = np.stack([np.cos(0.1 * K), 0.7 * np.sin(0.3 * K) - 0.2], -1)
NAMES = {"time": "timestamp", "q1": "actual_q_0", "q2": "actual_q_3"}
NAMES |= {"tau1": "effort 0", "tau2": "effort 3"}


def table(head=HEAD, sep=",", point=".", time=TIME, q=Q, tau=TAU, form="{:.9f}", before=()):
    """The motion as text; more columns come `before` it."""
    rows = [head.replace(",", sep)]
    for k, values in enumerate(zip(time, *np.transpose(q), *np.transpose(tau))):
        cells = [x if isinstance(x, str) else form.format(x) for x in values]
        rows.append(sep.join([*(str(x[k]) for x in before), *cells]).replace(".", point))
    return "\n".join(rows) + "\n"


def whole(first, step):
    return [str(first + step * k) for k in range(SAMPLES)]


def scaled(columns, factors):
    return np.asarray(columns) / np.asarray(factors)


EPOCH = 1_700_000_000
DEGREES = np.rad2deg(Q)
FORMATS = {
    "plain": (table(), {}),
    "semicolons, decimal commas": (table(sep=";", point=","), {}),
    "tabs, decimal commas": (table(sep="\t", point=","), {}),
    "blanks": (table(sep="   "), {}),
    "bars, Windows' line ends": (table(sep="|").replace("\n", "\r\n"), {}),
    "quoted cells, decimal commas": (
        re.sub(r"([^,\n]+,[^,\n]+)(,|$)", r'"\1"\2', table("h", point=","), flags=re.M)
        .replace("h\n", HEAD + "\n", 1),
        {},
    ),
    "a mark of utf-8": (table().encode("utf-8-sig"), {}),
    "utf-16": (table().encode("utf-16"), {}),
    "utf-16 without its mark": (table().encode("utf-16-le"), {}),
    "latin-1": (table("T °C,q1,q2,tau1,tau2").encode("latin-1"), {"columns": {"time": "T °C"}}),
    "gzip": (gzip.compress(table().encode()), {}),
    "quoted heads": (table('"time","q1","q2","tau1","tau2"'), {}),
    "blanks in heads": (table("time , q1, q2 ,tau1,  tau2 "), {}),
    "heads in capitals": (table("Time,Q1,Q2,Tau1,TAU2"), {}),
    "heads in a comment": ("# made by a logger\n" + table("# " + HEAD), {}),
    "no heads": (table("#"), {"columns": {n: k for k, n in enumerate(HEAD.split(","))}}),
    "units in brackets": (
        table("time [ms],q1 [deg],q2 (deg),tau1 [mNm],tau2 (N m)", time=1e3 * TIME, q=DEGREES,
              tau=scaled(TAU, [1e-3, 1])),
        {},
    ),
    "units behind blanks": (table("time (s),q1 [rad],q2,tau1,tau2", sep=" "), {}),
    "units behind strokes": (
        table("time_us,q1_deg,q2/deg,tau1/Nm,tau2", time=whole(0, 10_000), q=DEGREES), {},
    ),
    "units named": (
        table(time=whole(5, 10), q=scaled(Q, [1e-3, 2 * np.pi / 4096])),
        {"units": {"time": "ms", "q1": "mrad", "q2": 2 * np.pi / 4096}},
    ),
    "both joints' unit": (table(q=DEGREES), {"units": {"q": "deg"}}),
    "whole milliseconds": (table(time=whole(0, 10)), {}),
    "nanoseconds since 1970": (table(time=whole(EPOCH * 10**9, 10**7)), {}),
    "milliseconds since 1970": (table(time=whole(EPOCH * 1000, 10)), {}),
    "seconds since 1970": (table(time=[f"{EPOCH + t:.6f}" for t in TIME]), {}),
    "dates": (table(time=[f"2024-05-01T12:00:00.{10 * k:03d}Z" for k in K]), {}),
    "currents": (
        table(tau=scaled(TAU, [-0.7, 0.09]), head=HEAD.replace("tau1", "tau1 [A]")),
        {"factors": {"tau1": -0.7, "tau2": 0.09}},
    ),
    "two of many joints": (
        table("seq,x," + ",".join(NAMES.values()), before=(K, K**2)), {"columns": NAMES},
    ),
    "no time but a rate": (
        table("number" + HEAD[4:], time=whole(7, 1)), {"rate": 100},
    ),
    "an elbow counted from the ground": (
        table(q=np.stack([Q[:, 0], Q.sum(1)], -1)), {"absolute_elbow": True},
    ),
    "a separator at each line's end": (table().replace("\n", ",\n"), {}),
    "empty lines and remarks": (table().replace("\n", "\n\n# remark\n"), {}),
    "lines that are bad": (
        table() + "0.60,nan,1,1,1\n0.61,1,2\n0.61,1,2,3,four\n0.3,1,1,1,1\n", {"skip_bad": True},
    ),
}  # fmt: skip


def stored(folder, content, name="own.csv"):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize("kind", FORMATS)
def test_one_motion_in_many_formats(kind, tmp_path):
    """To 1e-8: what nine decimals of a degree, a count or a milliampere leave."""
    content, options = FORMATS[kind]
    recording = read_csv(stored(tmp_path, content), **options)
    assert recording.q.shape == recording.tau.shape == (1, SAMPLES, 2)
    np.testing.assert_allclose(recording.q[0], Q, atol=1e-8)
    np.testing.assert_allclose(recording.tau[0], TAU, atol=1e-8)
    np.testing.assert_allclose(recording.t - recording.t[0], TIME, atol=2e-7)
    assert recording.step == pytest.approx(0.01, rel=1e-5)
    plain = (
        *("plain", "blank", "bars", "quoted", "semicolons", "tabs", "utf", "a mark", "latin"),
        *("gzip", "heads", "no heads", "units behind blanks", "two", "no time", "empty", "a sep"),
    )
    assert bool(recording.notes) != kind.startswith(plain), recording.notes


@pytest.mark.parametrize("kind, told", [
    ("whole milliseconds", ["time is in milliseconds, as its numbers leave no doubt"]),
    ("nanoseconds since 1970", ["time is in nanoseconds", "time counts from 1970"]),
    ("dates", ["time holds dates"]),
    ("units named", ["time converted from ms to s, as units says", "q1 converted from mrad to rad",
                     "q2 converted from units of 0.00153398 to rad"]),
    ("units in brackets", ["time converted from ms to s, as its head says", "q1 converted from deg",
                           "q2 converted from deg", "tau1 converted from mNm to N m"]),
    ("currents", ["tau1 multiplied by -0.7", "tau2 multiplied by 0.09"]),
    ("an elbow counted from the ground", ["q2 was absolute; q1 was subtracted from it."]),
    ("lines that are bad", ["1 line with a wrong count of cells left out.",
                            "2 lines with a cell that is no number left out.",
                            "1 line not later than the line before left out."]),
])  # fmt: skip
def test_notes_say_what_reading_changed(kind, told, tmp_path):
    content, options = FORMATS[kind]
    path = stored(tmp_path, content)
    log = read_log(path, **options)
    assert len(log.notes) == len(told)
    for note, words in zip(log.notes, told):
        assert note.startswith(f"{path}: {words}"), note
    assert repr(log).splitlines() == ["Log(1 runs, 60 samples)", *(f"- {x}" for x in log.notes)]


def test_runs_come_from_a_column_or_from_files(tmp_path):
    one, other = stored(tmp_path, table(), "one.csv"), stored(tmp_path, table(), "other.csv")
    labels = ["b"] * 30 + ["a"] * 30
    times = np.r_[5 + TIME[:30], TIME[:30]]
    both = stored(tmp_path, table(f"run,{HEAD}", time=times, before=(labels,)), "both.csv")
    named = stored(tmp_path, table(f"trial,{HEAD}", time=times, before=(labels,)), "named.csv")
    recording = read_csv([one, other])
    assert recording.names == (str(one), str(other)) and recording.q.shape == (2, 60, 2)
    assert (recording.t == np.array([float(f"{t:.9f}") for t in TIME])).all()
    for recording in (read_csv(both), read_csv(named, run="trial")):
        path = recording.names[0].partition(",")[0]
        assert recording.names == (f"{path}, run b", f"{path}, run a")
        np.testing.assert_allclose(recording.q, Q.reshape(2, 30, 2), atol=1e-9)
        np.testing.assert_allclose(recording.t, TIME[:30], atol=1e-12)
        assert (recording.lines == 2 + K.reshape(2, 30)).all()
    one_run = recording[1]
    assert one_run.names == recording.names[1:] and one_run.lines.shape == (30,)
    assert recording[:1].names == recording.names[:1] and recording[:1].q.shape == (1, 30, 2)


def test_what_other_checks_judge_is_read_as_it_stands(tmp_path):
    """A wrapped angle, a spike, a joint without torque."""
    q = Q.copy()
    q[:, 0] = (6.2 + 0.05 * K) % (2 * np.pi)
    q[20, 1] += 0.5
    tau = TAU * [1, 0]
    recording = read_csv(stored(tmp_path, table(q=q, tau=tau)))
    np.testing.assert_allclose(recording.q[0], q, atol=1e-9)
    assert (recording.tau[0, :, 1] == 0).all() and recording.notes == ()
    passive = read_csv(stored(tmp_path, table()), columns={"tau2": None})
    assert (passive.tau[0, :, 1] == 0).all()
    assert passive.notes[0].endswith("tau2 is taken to be 0 throughout, as columns says.")


LONG = table() + '0.6,"' + "1,2,3,4\n" * 8000
ERRORS = [
    (table("time,angle,q2,tau1,tau2"), {},
     "own.csv, line 1: no column q1 in time, angle, q2, tau1, tau2; name what it is called by "
     "columns={...}"),
    (table("stamp,q1,q2,tau1,tau2"), {},
     "own.csv, line 1: no column time in stamp, q1, q2, tau1, tau2; name what it is called by "
     "columns={...}, or give rate=, in Hz"),
    (table("time,q1,q2,q1,tau1"), {},
     "own.csv, line 1: column q1 is there 2 times, at places 1, 3, counted from 0; choose by "
     'columns={"q1": 1}'),
    (f"{HEAD}\n0,1,2,3,4,5,6,7,8\n", {},
     "own.csv, line 2: 9 cells under 5 heads; decimal commas between commas cannot be told apart: "
     "write semicolons between columns, or decimal points"),
    (table(point=","), {},
     "own.csv, line 2: 10 cells under 5 heads; decimal commas between commas cannot be told apart: "
     "write semicolons between columns, or decimal points"),
    (table() + "0.6,1,2\n", {},
     "own.csv, line 62: 3 cells under 5 heads; skip_bad=True leaves such lines out"),
    (table(sep="\t").replace("\t", ",", 4), {},
     "own.csv, line 2: 1 cell under 5 heads; between cells is taken to be a comma, say separator= "
     "if not"),
    (table("time,q1,q2"), {},
     "own.csv, line 2: 5 cells under 3 heads, as on all lines; give the columns their heads in a "
     "copy of the file"),
    (table() + "0.6,1,NaN,1,1\n", {},
     "own.csv, line 62, column q2: must be a finite number, got 'NaN'; skip_bad=True leaves such "
     "lines out"),
    (table() + "0.6,1,1e999,1,1\n", {},
     "own.csv, line 62, column q2: must be a finite number, got '1e999'; skip_bad=True leaves such "
     "lines out"),
    (table() + "0.6,1,1,5 Nm,\n", {},
     "own.csv, line 62, column tau1: must be a finite number, got '5 Nm'; skip_bad=True leaves "
     "such lines out"),
    ("", {}, "own.csv: is empty"),
    (" \n\n", {}, "own.csv: is empty"),
    (HEAD, {}, "own.csv: no samples below the heads"),
    (b"PK\x03\x04", {}, "own.csv: is a zip archive or a spreadsheet, no text; export the log as "
     "CSV"),
    (b"a\0\0\1\2\3", {}, "own.csv: is no text file; export the log as CSV"),
    (table("#"), {},
     "own.csv, line 2: numbers, and no heads above them; give columns by their places, counted "
     'from 0, like columns={"time": 0, "q1": 1}'),
    (LONG, {}, "own.csv, line 62: a quote is opened and not closed on this line, at "
     '0.6,"1,2,3,4'),
    (table(time=whole(0, 1)), {},
     'own.csv, column time: steps of 1 may be "s" (1 s a step) or "ms" (0.001 s a step) or numbers '
     'of samples (then give rate= and no time); say which by units={"time": ...}'),
    (table(time=whole(0, 100)), {},
     'own.csv, column time: steps of 100 may be "ms" (0.1 s a step) or "us" (0.0001 s a step); say '
     'which by units={"time": ...}'),
    (table(q=DEGREES), {},
     "own.csv: q1 goes to 28.6462 (line 14): degrees, or radians of a joint that turns on? Say "
     'which by units={"q1": "deg"} or {"q1": "rad"}; or is that sample wrong?'),
    (table("time,q1 [gon],q2,tau1,tau2"), {},
     "own.csv, line 1: column q1 [gon]: units of q1 must be one of rad, mrad, deg, rev, or a "
     "number of SI units, got 'gon'; say which by units="),
    (table("time,q1,q2,tau1 [mA],tau2"), {},
     "own.csv: tau1 is a current, in mA; give its torque for an ampere, like "
     'factors={"tau1": 0.7} (N m/A)'),
    (table(), {"units": {"q1": "ms"}},
     "units of q1 must be one of rad, mrad, deg, rev, or a number of SI units, got 'ms'"),
    (table(), {"units": {"angle": "deg"}},
     "units must be for time, q1, q2, tau1, tau2, q, tau, got 'angle'"),
    (table(), {"factors": {"time": 2}}, "factors must be for q1, q2, tau1, tau2, got one for time"),
    (table(), {"factors": {"tau": 0}}, "factors of tau1 must not be 0, got 0"),
    (table(), {"columns": {"tau3": "tau2"}},
     "columns must name time, q1, q2, tau1, tau2, run, got 'tau3'; write "
     '{"q1": "its head in the file"}'),
    (table(), {"columns": {"q1": "q2"}},
     "columns: q1 and q2 must differ, got one head for both"),
    (table(), {"columns": {"q1": 7}}, "columns: q1 must be a place from 0 to 4, got 7"),
    (table(), {"rate": 0}, "rate must lie in (0, inf], got 0"),
    (table(), {"encoding": "klingon"}, "own.csv: encoding klingon does not fit: unknown encoding: "
     "klingon"),
    (table(), {"run": "trial"},
     "own.csv, line 1: no column trial in time, q1, q2, tau1, tau2; name what it is called by "
     "columns={...}"),
]  # fmt: skip


ARGUMENTS = [
    ({"columns": ["q1"]}, "columns must be a dictionary, like {'q1': 'its head'}, got ['q1']"),
    ({"units": "deg"}, "units must be a dictionary, like {'q1': 'deg'}, got 'deg'"),
    ({"factors": 2}, "factors must be a dictionary, like {'q1': 0.7}, got 2"),
    ({"columns": {"q1": None}}, "columns: q1 must be a head of the file or a place, got None"),
    ({"units": {"q1": 0}}, "units of q1 must lie in (0, inf], got 0"),
    ({"separator": ";;"}, "separator must be one character, like ';', got ';;'"),
    ({"separator": 5}, "separator must be text, got 5"),
    ({"decimal": "x"}, "decimal must be '.' or ',', got 'x'"),
    ({"encoding": 5}, "encoding must be text, got 5"),
    ({"step": 5}, "step must lie in [0.0001, 0.295], got 5"),
    ({"step": 1e-9}, "step must lie in [0.0001, 0.295], got 1e-09"),
]


@pytest.mark.parametrize("options, told", ARGUMENTS)
def test_errors_of_arguments_say_what_may_stand_there(options, told, tmp_path):
    with pytest.raises((TypeError, ValueError)) as error:
        read_csv(stored(tmp_path, table()), **options)
    assert str(error.value) == told


@pytest.mark.parametrize("content, options, told", ERRORS)
def test_errors_are_a_line_that_names_the_place(content, options, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stored(tmp_path, content)
    with pytest.raises(ValueError) as error:
        read_csv("own.csv", **options)
    assert str(error.value) == told and len(told) <= 300


def test_errors_stay_short_whatever_a_file_holds(tmp_path, monkeypatch):
    """Names, heads and cells of thousands of letters."""
    monkeypatch.chdir(tmp_path)
    deep = tmp_path / ("d" * 200) / ("e" * 200)
    deep.mkdir(parents=True)
    for content in (
        ",".join(f"{k}" + "h" * 100 for k in range(3000)) + "\n" + ",".join("1" * 3000),
        table().replace("0.500000000", "x" * 60_000, 1) + "0.6," + "y" * 60_000 + ",1,1,1",
        '"' * 60_001, f"{HEAD}\n" + "," * 60_000, LONG,
    ):  # fmt: skip
        with pytest.raises(ValueError) as error:
            read_csv(stored(deep, content))
        assert len(str(error.value)) <= 300 and "\n" not in str(error.value)
        assert "own.csv" in str(error.value) and "line" in str(error.value)


@pytest.mark.parametrize("paths, kind, told", [
    (b"x.csv", TypeError, "paths must be a path or a list of paths, as text or pathlib.Path, got "
     "b'x.csv'"),
    (["x.csv"], FileNotFoundError, "x.csv: no such file in "),
    ([3], TypeError, "paths must be a path or a list of paths, as text or pathlib.Path, got 3"),
    (None, TypeError, "paths must be a path or a list of paths, as text or pathlib.Path, got None"),
    ([], ValueError, "paths must name one file or more, got an empty list"),
    (".", IsADirectoryError, ".: is a folder; give its files, like "),
    ("cut.gz", OSError, "cut.gz: cannot be read: Compressed file ended before"),
])  # fmt: skip
def test_errors_of_paths(paths, kind, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stored(tmp_path, gzip.compress(table().encode())[:-30], "cut.gz")
    with pytest.raises(kind) as error:
        read_csv(paths)
    assert str(error.value).startswith(told) and len(str(error.value)) <= 300


def recorded(runs, start=-0.5, seed=0):
    rng = np.random.default_rng(seed)
    q, tau = rng.standard_normal((2, runs, 50, 2)) * 10.0 ** rng.integers(-12, 1, (runs, 50, 2))
    none = np.full_like(q, np.nan)
    t = start + np.arange(50) / 300
    return Recording(t, Trajectory(none, none, none), q, tau, none, none, none)


@pytest.mark.parametrize("name", ["own.csv", "own.csv.gz"])
def test_what_is_written_is_read_to_the_last_bit(name, tmp_path):
    for recording in (recorded(3), recorded(1, 12345.678)):
        write_csv(tmp_path / name, recording)
        again = read_csv(tmp_path / name)
        for one in ("t", "q", "tau"):
            assert (getattr(again, one) == getattr(recording, one)).all()
        assert again.notes == () and isinstance(again, LoggedRecording)
    write_csv(tmp_path / name, recording[0])
    assert (read_csv(tmp_path / name).q[0] == recording.q[0]).all()
    assert [path.name for path in tmp_path.iterdir()] == [name]
    first = "run,time,q1,q2,tau1,tau2\n1,12345.678,"
    packed = name.endswith("gz")
    raw = (tmp_path / name).read_bytes()
    assert (gzip.decompress(raw) if packed else raw).decode().startswith(first)


def test_a_file_stays_if_the_new_one_cannot_be_written(tmp_path):
    path = stored(tmp_path, table())
    broken = recorded(1)
    broken.q[0, 3, 1] = np.nan
    with pytest.raises(ValueError, match="finite angles and torques, got NaN in q"):
        write_csv(path, broken)
    with pytest.raises(TypeError, match="must be a Recording of one run or several, got str"):
        write_csv(path, "recording")
    assert path.read_text() == table() and [*tmp_path.iterdir()] == [path]


def test_pandas_comes_with_the_first_file_and_is_missed_in_a_line(tmp_path):
    path = stored(tmp_path, table())
    code = (
        "import sys; sys.modules['pandas'] = None\n"
        "import ddlib.logs\nddlib.logs.resample\n"
        f"try: ddlib.logs.read_csv({str(path)!r})\n"
        "except ImportError as error: print(error)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "reading a log needs pandas: pip install pandas"


@pytest.mark.slow
def test_a_million_lines_are_read_in_seconds(tmp_path):
    n = 1_000_000
    t = np.arange(n) / 1000
    lines = (f"{a:.3f},{b:.6f},{b:.6f},{b:.6f},{b:.6f}" for a, b in zip(t, np.sin(t)))
    path = stored(tmp_path, HEAD + "\n" + "\n".join(lines))
    start = time.perf_counter()
    recording = read_csv(path)
    assert time.perf_counter() - start < 20 and recording.q.shape == (1, n, 2)
    np.testing.assert_allclose(recording.q[0, :, 0], np.sin(t), atol=1e-6)
