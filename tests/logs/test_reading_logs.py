"""Logs of one's own arm: one known motion in many formats, and what errors say of the others."""

import bz2
import gzip
import re
import subprocess
import sys
import time

import numpy as np
import pandas
import pytest
from scipy.io import loadmat, savemat

from ddlib.logs import LoggedRecording, read_csv, read_frame, read_log, resample, write_csv
from ddlib.simulation import Recording
from ddlib.trajectories import Trajectory

HEAD = "time,q1,q2,tau1,tau2"
SAMPLES = 60
K = np.arange(SAMPLES)
TIME = 0.01 * K
Q = np.stack([0.5 * np.sin(0.13 * K), 0.9 + 0.3 * np.cos(0.2 * K)], -1)
TAU = np.stack([np.cos(0.1 * K), 0.7 * np.sin(0.3 * K) - 0.2], -1)
DEGREES = np.rad2deg(Q)
SIX = {"time": "stamp", "q1": "q_0", "q2": "q_3", "tau1": "effort 0", "tau2": "effort 3"}
EPOCH = 1_700_000_000


def table(head=HEAD, sep=",", point=".", time=TIME, q=Q, tau=TAU, before=()):
    """The motion as text; more columns come `before` it."""
    rows = [head.replace(",", sep)]
    for k, values in enumerate(zip(time, *np.transpose(q), *np.transpose(tau))):
        cells = [x if isinstance(x, str) else f"{x:.9f}" for x in values]
        rows.append(sep.join([*(str(x[k]) for x in before), *cells]).replace(".", point))
    return "\n".join(rows) + "\n"


def whole(first, step):
    return [str(first + step * k) for k in range(SAMPLES)]


FORMATS = {  # what is read, how, and what notes say of it
    "plain": (table(), {}, []),
    "semicolons, decimal commas": (table(sep=";", point=","), {}, []),
    "tabs, decimal commas": (table(sep="\t", point=","), {}, []),
    "blanks": (table(sep="   "), {}, []),
    "bars, Windows' line ends": (table(sep="|").replace("\n", "\r\n"), {}, []),
    "quoted cells, decimal commas": (
        re.sub(r"([^,\n]+,[^,\n]+)(,|$)", r'"\1"\2', table("h", point=","), flags=re.M)
        .replace("h\n", '"time",q1,q2,tau1,tau2\n', 1), {}, [],
    ),
    "a mark of utf-8": (table().encode("utf-8-sig"), {}, []),
    "utf-16": (table().encode("utf-16"), {}, []),
    "utf-16 without its mark": (table().encode("utf-16-le"), {}, []),
    "latin-1": (table("T °C,q1,q2,tau1,tau2").encode("latin-1"), {"columns": {"time": "T °C"}}, []),
    "gzip": (gzip.compress(table().encode()), {}, []),
    "blanks and capitals in heads": (table("Time , Q1, q2 ,tau1,  TAU2 "), {}, []),
    "heads in a comment": ("# made by a logger\n" + table("# " + HEAD), {}, ["1 line above the"]),
    "no heads": (
        table("#"), {"columns": {name: k for k, name in enumerate(HEAD.split(","))}}, [],
    ),
    "units in brackets": (
        table("time [ms],q1 [deg],q2 (deg),tau1 [mNm],tau2 (N m)", time=1e3 * TIME, q=DEGREES,
              tau=TAU / [1e-3, 1]), {},
        ["time converted from ms to SI units, as its head says.", "q1 converted from deg",
         "q2 converted from deg", "tau1 converted from mNm"],
    ),
    "units behind blanks": (table("time (s),q1 [rad],q2,tau1,tau2", sep=" "), {}, []),
    "units behind strokes": (
        table("time_us,q1_deg,q2/deg,tau1/Nm,tau2", time=whole(0, 10_000), q=DEGREES), {},
        ["time converted from us", "q1 converted", "q2 converted"],
    ),
    "units below heads": (
        table(HEAD + "\nms,deg,deg,Nm,N m", sep=";", time=whole(0, 10), q=DEGREES), {},
        ["time converted from ms", "q1 converted", "q2 converted"],
    ),
    "units named": (
        table(time=whole(5, 10), q=Q / [1e-3, 2 * np.pi / 4096]),
        {"units": {"time": "ms", "q1": "mrad", "q2": 2 * np.pi / 4096}},
        ["time converted from ms to SI units, as units says.", "q1 converted from mrad",
         "q2 converted from units of 0.00153398 to"],
    ),
    "both joints' unit": (table(q=DEGREES), {"units": {"q": "deg"}}, ["q1 conv", "q2 conv"]),
    "whole milliseconds": (
        table(time=whole(0, 10)), {}, ["time converted from ms to SI units, as its numbers leave"],
    ),
    "nanoseconds since 1970": (
        table(time=whole(EPOCH * 10**9, 10**7)), {}, ["time converted from ns", "time counts from"],
    ),
    "seconds since 1970": (
        table(time=[f"{EPOCH + t:.6f}" for t in TIME]), {}, ["time counts from 1970"],
    ),
    "dates": (
        table(time=[f"2024-05-01T12:00:00.{10 * k:03d}Z" for k in K]), {}, ["time holds dates"],
    ),
    "times of day": (
        table(time=[f"9:59:59,{10 * k:03d}" for k in K], sep=";", point=","), {}, ["time holds"],
    ),
    "currents": (
        table(tau=TAU / [-0.7, 0.09], head=HEAD.replace("tau1", "tau1 [A]")),
        {"factors": {"tau1": -0.7, "tau2": 0.09}}, ["tau1 multiplied by -0.7", "tau2 multiplied"],
    ),
    "two of six joints": (
        table("q_1,q_2,q_4,q_5," + ",".join(SIX.values()), before=(K, -K, K**2, K)),
        {"columns": SIX}, ["there are 6 such joints; these equations are of two with parallel"],
    ),
    "no time but a rate": (table("number" + HEAD[4:], time=whole(7, 1)), {"rate": 100}, []),
    "an elbow counted from the ground": (
        table(q=np.stack([Q[:, 0], Q.sum(1)], -1)), {"absolute_elbow": True},
        ["q2 was absolute; q1 was subtracted from it."],
    ),
    "a separator at each line's end": (table().replace("\n", ",\n"), {}, []),
    "empty lines and remarks": (table().replace("\n", "\n\n# remark\n"), {}, ["61 lines above"]),
    "lines that are bad": (
        table() + "0.60,nan,1,1,1\n0.61,1,2\n0.61,1,2,3,four\n0.3,1,1,1,1\n", {"skip_bad": True},
        ["1 line of another count of cells", "2 lines with a cell that is no number left out.",
         "1 line not later than the one before left out."],
    ),
    "a frame": (pandas.read_csv, {}, []),
    "arrays": (lambda _: {"time": TIME, "q": Q, "tau": TAU, "rate": 100.0}, {}, []),
    "arrays of all joints": (
        lambda _: {"t": TIME, "pos": np.hstack([Q, 0 * Q]), "effort": np.hstack([TAU, 0 * TAU])},
        {"columns": dict(zip(HEAD.split(","), ("t", "pos1", "pos2", "effort1", "effort2")))},
        ["there are 4 such joints"],
    ),
    "dates in a frame": (
        lambda _: {"time": pandas.Timestamp("2024-05-01") + pandas.to_timedelta(TIME, "s"),
                   "q": Q, "tau": TAU}, {}, ["time holds dates"],
    ),
}  # fmt: skip


def stored(folder, content, name="own.csv"):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize("kind", FORMATS)
def test_one_motion_in_many_formats(kind, tmp_path):
    """To 1e-8: what nine decimals of a degree, a count or a milliampere leave."""
    content, options, told = FORMATS[kind]
    if callable(content):
        log = read_frame(content(stored(tmp_path, table())), **options)
    else:
        log = read_log(stored(tmp_path, content), **options)
    (run,) = log.runs
    np.testing.assert_allclose(run.q, Q, atol=1e-8)
    np.testing.assert_allclose(run.tau, TAU, atol=1e-8)
    np.testing.assert_allclose(run.t - run.t[0], TIME, atol=2e-7)
    assert resample(log).step == pytest.approx(0.01, rel=1e-5)
    notes = [note.partition(": ")[2] for note in log.notes]
    assert len(notes) == len(told) and all(map(str.startswith, notes, told)), notes
    assert repr(log).splitlines() == ["Log(1 runs, 60 samples)", *(f"- {x}" for x in log.notes)]


def test_runs_come_from_a_column_or_from_files(tmp_path):
    one, other = stored(tmp_path, table(), "one.csv"), stored(tmp_path, table(), "other.csv")
    labels = ["b"] * 30 + ["a"] * 30
    times = np.r_[5 + TIME[:30], TIME[:30]]
    both = stored(tmp_path, table(f"run,{HEAD}", time=times, before=(labels,)), "both.csv")
    named = stored(tmp_path, table(f"trial,{HEAD}", time=times, before=(labels,)), "named.csv")
    recording = read_csv([one, other])
    assert recording.names == (str(one), str(other)) and recording.q.shape == (2, 60, 2)
    for recording in (read_csv(both), read_csv(named, run="trial")):
        path = recording.names[0].partition(",")[0]
        assert recording.names == (f"{path}, run b", f"{path}, run a")
        np.testing.assert_allclose(recording.q, Q.reshape(2, 30, 2), atol=1e-9)
        np.testing.assert_allclose(recording.t, TIME[:30], atol=1e-12)
        assert (recording.lines == 2 + K.reshape(2, 30)).all()
    one_run = recording[1]
    assert one_run.names == recording.names[1:] and one_run.lines.shape == (30,)
    assert recording[:1].names == recording.names[:1] and recording[:1].q.shape == (1, 30, 2)


def test_a_bad_line_leaves_its_place_in_a_file_with_a_rate(tmp_path):
    text = table("n,q1,q2,tau1,tau2").replace(f"{Q[20, 0]:.9f}", "-", 1)
    (run,) = read_log(stored(tmp_path, text), rate=100, skip_bad=True).runs
    np.testing.assert_allclose(run.t, np.delete(TIME, 20), atol=1e-12)


def test_masked_samples_are_refused_or_counted():
    q = np.ma.array(Q, mask=False)
    q[[7, 8, 30], 1] = np.ma.masked
    arrays = {"time": TIME, "q": q, "tau": TAU}
    with pytest.raises(ValueError, match=r"^frame, row 7, column q2: must be a finite number, got"):
        read_frame(arrays)
    log = read_frame(arrays, skip_bad=True)
    assert log.notes == ("frame: 3 rows with a cell that is no number left out.",)
    assert (log.runs[0].lines == np.delete(K, [7, 8, 30])).all()


@pytest.mark.parametrize("name, save, load", [
    ("own.npz", lambda path, arrays: np.savez(path, **arrays), np.load),
    ("own.mat", lambda path, arrays: savemat(path, arrays), loadmat),
    ("own.json", lambda path, arrays: pandas.DataFrame(
        {name: list(x) for name, x in arrays.items()}).to_json(path, orient="records"),
     pandas.read_json),
])  # fmt: skip
def test_other_files_are_read_as_their_error_says(name, save, load, tmp_path):
    path = tmp_path / name
    save(path, {"time": TIME, "q": Q, "tau": TAU})
    with pytest.raises(ValueError, match=f"is no table of text; read_frame.*{load.__name__}"):
        read_log(path)
    np.testing.assert_allclose(read_frame(load(path)).runs[0].q, Q, atol=1e-9)


def test_files_of_matlab_hold_more_than_arrays(tmp_path):
    """What is one number or text is passed over; a struct's error says how to get its fields."""
    path, arrays = tmp_path / "own.mat", {"time": TIME, "q": Q, "tau": TAU}
    savemat(path, arrays | {"Ts": 0.01, "name": "own", "arm": {"mass": 1.0}})
    np.testing.assert_allclose(read_frame(loadmat(path)).runs[0].q, Q, atol=1e-9)
    savemat(path, {"data": arrays})
    with pytest.raises(ValueError, match=r"got none; the fields of data .*simplify_cells=True"):
        read_frame(loadmat(path))
    fields = loadmat(path, simplify_cells=True)["data"]
    np.testing.assert_allclose(read_frame(fields).runs[0].q, Q, atol=1e-9)


ERRORS = [
    (table("stamp,q1,q2,tau1,tau2"), {},
     r"own.csv, line 1: no column time in stamp, q1, q2, tau1, tau2; say what it is called by "
     r"columns=\{...\}, or give rate=, in Hz"),
    (table("time,q1,q2,a,b"), {}, r"own.csv, line 1: no column tau1, tau2 in time, q1, q2, a, b"),
    (table("time,q1,q2,q1,tau1"), {},
     r'own.csv, line 1: column q1 is there more than once, at places \[1, 3\].*\{"q1": 1\}'),
    (table(point=","), {}, r"own.csv, line 2: 10 cells, and no line of as many heads .* decimal"),
    (table("#"), {}, r'own.csv, line 2: 5 cells, and no line of .*columns=\{"time": 0\}'),
    (table() + "0.6,1,2\n", {}, r"own.csv, line 62: 3 cells, where 5 are usual; skip_bad=True"),
    (table() + '0.6,"1,2,3,4\n', {}, r"own.csv, line 62: 2 cells, where 5 are usual"),
    (table(sep="\t"), {"separator": ","}, r"own.csv: has no line of two numbers; .* separator="),
    (table() + "0.6,1,1,5 Nm,\n", {}, r"own.csv, line 62, column tau1: must be .* got '5 Nm'; s"),
    (" \n\n", {}, r"own.csv: is empty"),
    (HEAD + "\n0,1,1,1,1", {}, r"own.csv: must have three samples or more, got 1"),
    (b"a\0\0\1\2\3", {}, r"own.csv: is no text file; read_frame takes"),
    (table(time=whole(0, 1)), {},
     r'own.csv, line 1, column time: steps of 1 may be "s" \(1 s a step\) or "ms" .* or numbers of '
     r'samples \(then give rate= and no time\); say which by units=\{"time": ...\}'),
    (table(time=np.float32(EPOCH + TIME)), {},
     r"own.csv, line 1, column time: numbers near 1.7e\+09 in single precision .* are 128 apart"),
    (table(q=DEGREES), {}, r"own.csv, line 1, column q1: goes to 28.6462: degrees, or a joint"),
    (table("time,q1 [gon],q2,tau1,tau2"), {}, r"q1 must be one of rad, mrad, deg, rev, .*'gon'"),
    (table("time,q1,q2,tau1 [mA],tau2"), {}, r'is a current; .*factors=\{"tau1": 0.7\}'),
    (table("time,q1,q2,elbow_current,tau2"), {"columns": {"tau1": "elbow_current"}},
     r'column elbow_current: is a current; .*factors=\{"tau1": 0.7\}'),
    (table(), {"encoding": "klingon"}, r"own.csv: encoding klingon does not fit: unknown encoding"),
    (table(), {"columns": {"tau1": "q1"}}, r"columns: tau1 must have .* by pandas\.merge"),
    (table(), {"columns": {"q1": 7}}, r"columns: the place of q1 must be an integer from 0 to 4"),
    (table(), {"columns": ["q1"]}, r"columns must be a mapping, like \{'q1': ...\}, got"),
    (table(), {"units": {"angle": "deg"}}, r"names in units must be one of 'time', 'q1'"),
    (table(), {"factors": {"q1": "2"}}, r"factors of q1 must be a single number"),
    (table(), {"separator": ";;"}, r"separator must be one character, like ';', got ';;'"),
    (table(), {"skip_bad": "no"}, r"skip_bad must be True or False, got 'no'"),
    (table(), {"paths": [3]}, r"paths must be of class str or PathLike, got 3"),
    (table(), {"paths": []}, r"paths must name one file or more, got none"),
    (table(), {"paths": "x.csv"}, r"x.csv: cannot be read: \[Errno 2\] No such file"),
    (gzip.compress(table().encode())[:-30], {}, r"own.csv: cannot be read: Compressed file ended"),
]  # fmt: skip


@pytest.mark.parametrize("content, options, told", ERRORS)
def test_errors_are_a_line_that_names_the_place(content, options, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stored(tmp_path, content)
    with pytest.raises((ValueError, TypeError, OSError), match=told) as error:
        read_csv(**{"paths": "own.csv", **options})
    assert len(str(error.value)) <= 300 and "\n" not in str(error.value)


@pytest.mark.parametrize("frame, kind, told", [
    (Q, TypeError, "frame must be a DataFrame or a mapping of arrays, got an array of shape"),
    ({"time": TIME, "q": Q[1:]}, ValueError, "frame must hold arrays .samples,. or"),
    ({"time": np.float32(EPOCH + TIME), "q": Q, "tau": TAU}, ValueError,
     "frame, column time: numbers near .* in single precision .float32. are 128 apart"),
    ({"time": TIME, "q": Q + 1j, "tau": TAU}, ValueError, "frame, row 0, column q1: must be a fin"),
])  # fmt: skip
def test_errors_of_frames(frame, kind, told):
    with pytest.raises(kind, match=told):
        read_frame(frame)


ODD = {
    "a line of 100 kB": table() + "0.6," + "1" * 100_000 + ",1,1,1",
    "blanks in a head": table("time,q1" + " " * 20_000 + "[deg,q2,tau1,tau2"),
    "digits in a head": table("time,q" + "1" * 20_000 + "x,q2,tau1,tau2"),
    "brackets in a head": table("time," + "[" * 9_000 + "q1,q2,tau1,tau2"),
    "digits in a cell": table().replace("0.500000000", "1" * 19_000 + "x", 1),
    "separators": HEAD + "\n" + "," * 60_000,
    "quotes": '"' * 60_001,
    "300 MB in gzip": 30 * gzip.compress(b"0" * 10_000_000),
    "5 GB in 23 kB of bz2": 500 * bz2.compress(b"0" * 10_000_000),
}


@pytest.mark.parametrize("kind", ODD)
def test_odd_files_are_refused_within_a_second(kind, tmp_path):
    deep = tmp_path / ("d" * 200) / ("e" * 200)
    deep.mkdir(parents=True)
    path = stored(deep, ODD[kind])
    read_csv(stored(deep, table(), "fine.csv"))
    start = time.process_time()
    with pytest.raises(ValueError) as error:
        read_csv(path)
    assert time.process_time() - start < 1.0
    assert "own.csv" in str(error.value) and len(str(error.value)) <= 300
    assert "\n" not in str(error.value)


def recorded(runs, start=-0.5):
    rng = np.random.default_rng(0)
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
    raw = (tmp_path / name).read_bytes()
    text = (gzip.decompress(raw) if name.endswith("gz") else raw).decode()
    assert text.startswith("run,time,q1,q2,tau1,tau2\n1,12345.678,")
    recording.q[0, 3, 1] = np.nan
    with pytest.raises(ValueError, match=r"recording\.q must be finite"):
        write_csv(tmp_path / name, recording)
    assert (tmp_path / name).read_bytes() == raw and len([*tmp_path.iterdir()]) == 1


def test_pandas_comes_with_the_first_file():
    code = "import sys, ddlib.logs; ddlib.logs.resample; assert 'pandas' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.slow
def test_a_million_lines_are_read_in_seconds(tmp_path):
    t = np.arange(1_000_000) / 1000
    lines = (f"{a:.3f},{b:.6f},{b:.6f},{b:.6f},{b:.6f}" for a, b in zip(t, np.sin(t)))
    path = stored(tmp_path, HEAD + "\n" + "\n".join(lines))
    start = time.process_time()
    recording = read_csv(path)
    assert time.process_time() - start < 10 and recording.q.shape == (1, t.size, 2)
    np.testing.assert_allclose(recording.q[0, :, 0], np.sin(t), atol=1e-6)
