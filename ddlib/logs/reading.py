"""Logs of a reader's own arm, from files, frames and arrays, and recordings to a file."""

from __future__ import annotations

import gzip
import os
import re
from collections.abc import Mapping

import numpy as np

from ddlib._check import finite_array, flag, instance, integer, number, one_of, series, text, told
from ddlib._files import write_whole
from ddlib.logs._text import Table, fault, read_text, shortened
from ddlib.logs._units import (
    check_precision,
    guessed_unit,
    in_head,
    in_si,
    since_1970,
    size_of,
    spelled,
)
from ddlib.logs.log import Log, LoggedRecording, LoggedRun
from ddlib.logs.resampling import on_one_grid
from ddlib.simulation import Recording
from ddlib.tables import plural

_JOINTS = {"q": ("q1", "q2"), "tau": ("tau1", "tau2")}
_MEASURED = ("q1", "q2", "tau1", "tau2")
_QUANTITIES = ("time", *_MEASURED)
_TURNS = 4 * np.pi  # rad: no joint of an arm goes further without a word


def read_log(
    paths,
    columns: Mapping | None = None,
    units: Mapping | None = None,
    factors: Mapping | None = None,
    *,
    rate: float | None = None,
    run: str | int | None = None,
    separator: str | None = None,
    decimal: str | None = None,
    encoding: str | None = None,
    absolute_elbow: bool = False,
    skip_bad: bool = False,
) -> Log:
    """Read times, angles and torques of a two-link arm from text files, as they were logged.

    Separator, decimal sign, encoding, packing (gzip, bz2, xz), lines above the heads and units
    below them are found. Lines that are empty or begin with ``#`` or ``%`` are passed over, unless
    the heads stand there.

    Parameters
    ----------
    paths : path or list of paths
        Each file holds a run, or several with a column that tells them apart.
    columns : mapping, optional
        Heads in the file of time, q1, q2, tau1, tau2 and run, where they differ:
        ``{"time": "timestamp", "q1": "actual_q_0"}``. A number is a column's place, counted
        from 0. None is for a joint without torque, ``{"tau2": None}``, and for one that is locked,
        as in a log of a single joint: ``{"q2": None, "tau2": None}``.
    units : mapping, optional
        Units of columns that are not in s, rad, N m: ``{"time": "ms", "q1": "deg", "q2": "deg"}``;
        "q" and "tau" stand for both joints. Known are s, ms, us, ns; rad, mrad, deg, rev; Nm, mNm,
        Ncm, kNm; A, mA; and a number is what one unit is in SI units, like ``2 * pi / 4096`` for
        counts of an encoder. Without it the head's own counts, as in "q1 [deg]", "time_ms",
        "tau1/Nm".
    factors : mapping, optional
        What to multiply angles and torques by, like N m/A for currents, with a sign.
    rate : float, optional
        Lines in a second, Hz, for files without a time.
    run : str or int, optional
        Column that tells runs of a file apart; default: "run", if there is one.
    separator, decimal, encoding : str, optional
        As in the files.
    absolute_elbow : bool
        Whether the elbow's angle is counted from where the shoulder's is, not from the upper
        arm. Torques stay: they are those of the joints' motors.
    skip_bad : bool
        Whether to leave out lines with a wrong count of cells, a cell that is no finite number, or
        a time that is not later than the line before's.

    Returns
    -------
    Log
        In s, rad, N m; times of a clock that counts from 1970 begin at 0. Where a file's time
        begins again, so does a run. `notes` say what was converted or left out.

    Raises
    ------
    ValueError
        In one line with file, line and column: if a column is missing or there twice, a cell is no
        finite number, lines have more cells than heads, or a unit is in doubt.
    OSError
        If a file cannot be read.
    """
    for name, value in {"separator": separator, "decimal": decimal, "encoding": encoding}.items():
        if value is not None:
            text(name, value)
    if separator not in (None, r"\s+") and (len(separator) != 1 or separator in '"\n'):
        raise ValueError(f"separator must be one character, like ';', got {told(separator)}")
    one_of("decimal", decimal, (None, ".", ","))
    tables = (read_text(path, separator, decimal, encoding, skip_bad) for path in _as_paths(paths))
    return _log(tables, columns, units, factors, rate, run, absolute_elbow, skip_bad)


def read_frame(
    frame,
    columns: Mapping | None = None,
    units: Mapping | None = None,
    factors: Mapping | None = None,
    *,
    rate: float | None = None,
    run: str | int | None = None,
    absolute_elbow: bool = False,
    skip_bad: bool = False,
) -> Log:
    """Take times, angles and torques from a frame of pandas or from arrays, as `read_log` does.

    Parameters
    ----------
    frame : pandas.DataFrame or mapping
        Columns by their names, or arrays (samples,) by theirs. An array (samples, joint) stands for
        a column for each joint: that of "q" for "q1", "q2" and so on. Masked samples are bad ones.
    columns, units, factors, rate, run, absolute_elbow, skip_bad
        Those of `read_log`, with rows for lines.

    Returns
    -------
    Log
        As of `read_log`; `lines` are rows of the frame, counted from 0.

    Raises
    ------
    TypeError
        If `frame` is neither a frame nor a mapping.
    ValueError
        In one line with row and column, as `read_log`.
    """
    tables = [Table("frame", _as_frame(frame), "frame", "row")]
    return _log(tables, columns, units, factors, rate, run, absolute_elbow, skip_bad)


def read_csv(
    paths,
    columns: Mapping | None = None,
    units: Mapping | None = None,
    factors: Mapping | None = None,
    *,
    step: float | None = None,
    longest_gap: int = 3,
    seconds: float | None = None,
    trust_stamps: bool = True,
    **options,
) -> LoggedRecording:
    """Read files and bring their samples onto an even grid: `read_log`, then `resample`.

    Parameters
    ----------
    paths, columns, units, factors, **options
        Those of `read_log`.
    step, longest_gap, seconds, trust_stamps
        Those of `resample`.

    Returns
    -------
    LoggedRecording
        Arrays (runs, time, 2). A file of equal steps comes through unchanged; else `notes` say
        what was done.
    """
    log = read_log(paths, columns, units, factors, **options)
    return on_one_grid(log, step, longest_gap, seconds, trust_stamps)


def write_csv(path, recording: Recording) -> None:
    """Write times, angles and torques, which `read_csv` reads to the last digit.

    Columns are run, time (s), q1, q2 (rad), tau1, tau2 (N m). A name that ends in .gz packs the
    file. A file that is there is replaced once the new one is whole.

    Parameters
    ----------
    path : path
        File to write.
    recording : Recording
        One run, or several of equal length.
    """
    import pandas

    instance("recording", recording, Recording)
    (path,) = _as_paths(path)
    q, tau = (finite_array(f"recording.{n}", getattr(recording, n), 2) for n in ("q", "tau"))
    runs, samples = q.size // (2 * len(recording.t)), len(recording.t)
    columns = {"run": np.repeat(np.arange(1, runs + 1), samples)}
    columns |= {"time": np.tile(recording.t, runs), "q1": q[..., 0], "q2": q[..., 1]}
    columns |= {"tau1": tau[..., 0], "tau2": tau[..., 1]}
    frame = pandas.DataFrame({name: values.ravel() for name, values in columns.items()})
    content = frame.to_csv(index=False, lineterminator="\n").encode()
    write_whole(path, gzip.compress(content, mtime=0) if path.endswith(".gz") else content)


def _as_paths(paths) -> list[str]:
    """One path or several as a list of text."""
    if isinstance(paths, (str, os.PathLike)):
        paths = [paths]
    paths = [os.fspath(path) for path in series("paths", paths, str, os.PathLike)]
    if not paths:
        raise ValueError("paths must name one file or more, got none")
    return paths


def _by_quantity(argument: str, given, known) -> dict:
    """A mapping by quantity; "q" and "tau" stand for both joints."""
    if given is not None and not isinstance(given, Mapping):
        raise TypeError(f"{argument} must be a mapping, like {{'q1': ...}}, got {told(given)}")
    by_quantity = {}
    for key, value in (given or {}).items():
        for name in _JOINTS.get(key, (key,)):
            one_of(f"names in {argument}", name, known)
            by_quantity[name] = value
    return by_quantity


def _as_frame(frame):
    """A frame or arrays by name as a frame with a column for each joint."""
    import pandas

    if not isinstance(frame, (pandas.DataFrame, Mapping)):
        raise TypeError(f"frame must be a DataFrame or a mapping of arrays, got {told(frame)}")
    parts, structs = [], []
    for head, values in frame.items():
        if getattr(getattr(values, "dtype", None), "names", None):
            structs.append(head)
            continue
        if isinstance(values, pandas.Series) and isinstance(next(iter(values), None), list):
            values = values.to_list()  # as in records of JSON
        if np.ndim(values) in (1, 2) and (np.size(values) > 1 or head in _QUANTITIES):
            part = pandas.DataFrame(values).reset_index(drop=True)
            part = part.T if len(part) == 1 else part  # a row of MATLAB
            joints = range(1, part.shape[1] + 1)
            part.columns = [f"{head}{k}" if len(joints) > 1 else str(head) for k in joints]
            parts.append(part)
    if len({len(part) for part in parts}) != 1:
        got = ", ".join(f"{part.columns[0]} {len(part)}" for part in parts) or "none"
        inside = "".join(
            f"; the fields of {head} are in loadmat(path, simplify_cells=True)[{head!r}]"
            for head in structs[:1]
        )
        raise fault(
            "frame must hold arrays (samples,) or (samples, joint) of one length, got "
            f"{got}{inside}"
        )
    return pandas.concat(parts, axis=1)


def _log(tables, columns, units, factors, rate, run, absolute_elbow, skip_bad) -> Log:
    """The runs of tables in SI units, and what was changed."""
    wanted = {name: name for name in _QUANTITIES}
    wanted |= _by_quantity("columns", columns, (*_QUANTITIES, "run"))
    if run is not None:
        wanted["run"] = run
    if rate is not None:
        number("rate", rate, 0.0, open_low=True)
        del wanted["time"]
    units = _by_quantity("units", units, _QUANTITIES)
    factors = _by_quantity("factors", factors, _MEASURED)
    flag("absolute_elbow", absolute_elbow)
    flag("skip_bad", skip_bad)
    runs, notes = [], []
    for table in tables:
        places = _places(table, wanted)
        data = table.frame.iloc[:, list(places.values())].set_axis(list(places), axis=1)
        if rate is not None:
            data["time"] = np.arange(len(data)) / rate
        told_units = dict(units)
        if (clock := _clock(data["time"])) is not None:
            data["time"], told_units["time"] = clock, "s"
            table.notes.append("time holds dates or times of day; it is counted from the first.")
        data = _finite(table, data, places, skip_bad)
        for name, place in places.items():
            if name != "run":
                unit, factor = told_units.get(name), factors.get(name)
                data[name] = _in_si(table, name, place, data[name].to_numpy(), unit, factor)
        data = data.reindex(columns=[*data.columns.union(_QUANTITIES)], fill_value=0.0)
        if absolute_elbow:
            data["q2"] -= data["q1"]
            table.notes.append("q2 was absolute; q1 was subtracted from it.")
        joints = _joints_like(table, places)
        if joints > 2:
            others = "these equations are of two with parallel axes, all others locked"
            table.notes.append(f"there are {joints} such joints; {others}.")
        runs += _runs(table, data, joints, skip_bad)
        notes += [f"{shortened(table.path, 100)}: {note}" for note in table.notes]
    return Log(tuple(runs), tuple(notes))


def _places(table: Table, wanted: dict) -> dict[str, int]:
    """Places of the columns that are read."""
    heads = [str(head) for head in table.frame.columns]
    if "run" not in wanted and _named(heads, "run", "run"):
        wanted = wanted | {"run": "run"}
    places, missing = {}, []
    for name, head in wanted.items():
        if head is None and name in _MEASURED[1:]:
            table.notes.append(f"{name} is taken to be 0 throughout, as columns says.")
            continue
        is_place = isinstance(head, (int, np.integer))
        found = [head] if is_place else _named(heads, name, str(head))
        if len(found) > 1:
            choice = f'at places {found} from 0; choose by columns={{"{name}": {found[0]}}}'
            raise fault(
                f"{table.where}: column {shortened(head)} is there more than once, {choice}"
            )
        if not found:
            missing.append(str(head))
        elif found[0] in places.values():
            merged = "files of angles and of torques are joined by pandas.merge, for read_frame"
            raise fault(f"columns: {name} must have a column of its own, got {head!r}; {merged}")
        else:
            last = len(heads) - 1
            places[name] = integer(f"columns: the place of {name}", found[0], 0, last)
    if missing and heads == [str(k) for k in range(len(heads))]:
        raise fault(
            f"{table.where}: {len(heads)} cells, and no line of as many heads above; give columns "
            f'by places from 0, like columns={{"time": 0}}; if commas are decimal signs, too, '
            f"write semicolons between cells"
        )
    if missing:
        sought = shortened(", ".join(missing), 60)
        known = shortened(", ".join(filter(None, heads)), 90)
        advice = "say what it is called by columns={...}"
        rate = ", or give rate=, in Hz" if missing == ["time"] else ""
        raise fault(f"{table.where}: no column {sought} in {known}; {advice}{rate}")
    return places


def _named(heads: list[str], quantity: str, head: str) -> list[int]:
    """Places of columns with a head, as it stands, or else without its unit and capitals."""
    head = " ".join(head.split())
    exact = [place for place, known in enumerate(heads) if known == head]
    names = [in_head(known, quantity)[0].lower() for known in heads]
    return exact or [place for place, name in enumerate(names) if name == head.lower()]


def _finite(table: Table, data, places: dict[str, int], skip_bad: bool):
    """The rows of a frame in which all is a finite number."""
    fine = np.ones(len(data), bool)
    for name in data.columns.drop("run", errors="ignore"):
        cells, data[name] = data[name], _numbers(data[name])
        bad = np.flatnonzero(~np.isfinite(data[name]))
        if bad.size and not skip_bad:
            place = f"{shortened(table.path, 100)}, {table.row} {data.index[bad[0]]}"
            head, cell = table.frame.columns[places[name]], shortened(cells.iloc[bad[0]])
            raise fault(
                f"{place}, column {shortened(head)}: must be a finite number, got {cell!r}; "
                f"skip_bad=True leaves such {table.row}s out"
            )
        fine[bad] = False
    if not fine.any():
        raise fault(f"{table.where}: no {table.row} has finite numbers in all columns")
    others = int((~fine).sum()) - table.misfits
    if table.misfits:
        table.notes.append(f"{plural(table.misfits, 'line')} of another count of cells left out.")
    if others:
        table.notes.append(f"{plural(others, table.row)} with a cell that is no number left out.")
    return data[fine].copy()


def _in_si(table: Table, name: str, place: int, values, unit, factor) -> np.ndarray:
    """A column in s, rad or N m; a ValueError if its unit is in doubt."""
    head = str(table.frame.columns[place])
    where, source = f"{table.where}, column {shortened(head)}", "units says"
    if unit is None:
        unit, source = in_head(head, name)[1], "its head says"
    try:
        if name == "time":
            check_precision(values)
        if name == "time" and unit is None:
            unit, source = guessed_unit(values), "its numbers leave no doubt"
        size = 1.0 if unit is None else size_of(unit, name)
    except ValueError as error:
        raise fault(f"{where}: {error}") from None
    if size != 1.0:
        written = unit if isinstance(unit, str) else f"units of {unit:g}"
        table.notes.append(f"{name} converted from {written} to SI units, as {source}.")
    if name == "time" and since_1970(abs(float(values[0])) * size):
        values = values - values[0]  # whole numbers stay exact
        table.notes.append("time counts from 1970; the first time was subtracted.")
    values = in_si(values.astype(float), size)
    if factor is not None:
        factor = number(f"factors of {name}", factor)
        table.notes.append(f"{name} multiplied by {factor:g}, as factors says.")
        return values * factor
    if isinstance(unit, str) and spelled(unit) in ("A", "mA"):
        advice = f'give its torque for an ampere, like factors={{"{name}": 0.7}} (N m/A)'
        raise fault(f"{where}: is a current; {advice}")
    farthest = values[np.argmax(np.abs(values))]
    if unit is None and name in _JOINTS["q"] and abs(farthest) > _TURNS:
        advice = f'say by units={{"{name}": "deg"}} or {{"{name}": "rad"}}'
        raise fault(f"{where}: goes to {farthest:g}: degrees, or a joint that turns on? {advice}")
    return values


def _runs(table: Table, data, joints: int, skip_bad: bool) -> list[LoggedRun]:
    """Runs, which have a label of their own, or begin where their time does."""
    groups, word = [(table.path, data)], "run"
    if "run" in data:
        labels = data["run"].convert_dtypes().astype(str)
        groups = [(f"{table.path}, run {x}", part) for x, part in data.groupby(labels, sort=False)]
        word = "part"
    runs, begun, late = [], [], 0
    for name, group in groups:
        t, lines = group["time"].to_numpy(), group.index.to_numpy()
        q, tau = (group[list(names)].to_numpy() for names in _JOINTS.values())
        early = t[0] + 0.1 * (np.maximum.accumulate(t) - t[0])
        begins = np.flatnonzero((np.diff(t) < 0) & (t[1:] <= early[:-1])) + 1
        begun += [*lines[begins]]
        for k, rows in enumerate(np.split(np.arange(len(t)), begins)):
            if skip_bad:
                later = np.r_[True, np.diff(np.maximum.accumulate(t[rows])) > 0]
                late, rows = late + int((~later).sum()), rows[later]
            of_run = f"{name}, {word} {k + 1}" if begins.size else name
            runs.append(LoggedRun(of_run, t[rows], q[rows], tau[rows], lines[rows], joints))
    if begun:
        places = f"{plural(len(begun), 'place')}, the first at {table.row} {begun[0]}"
        table.notes.append(f"time begins again at {places}; a run begins there.")
    if late:
        table.notes.append(f"{plural(late, table.row)} not later than the one before left out.")
    return runs


def _joints_like(table: Table, places: dict[str, int]) -> int:
    """For how many joints there are heads like that of q1, but for their last number."""
    kinds = []
    for head in table.frame.columns:
        parts = re.split(r"(\d+)", str(head))
        kinds.append("#".join(["".join(parts[:-2]), parts[-1]]))
    others = [kinds[place] for name, place in places.items() if name not in _JOINTS["q"]]
    kind = kinds[places["q1"]]
    return 2 if kind in others else max(2, kinds.count(kind))  # "column 7" tells nothing


def _clock(cells):
    """Dates or times of day as s since the first; None if they are neither."""
    import pandas

    if cells.dtype.kind not in "mM":
        if pandas.to_numeric(cells, errors="coerce").notna().mean() >= 0.5:
            return None
        cells = cells.astype(str).str.replace(",", ".")
    iso = {"format": "ISO8601", "utc": True}
    for convert, options in ((pandas.to_timedelta, {}), (pandas.to_datetime, iso)):
        try:
            moments = convert(cells, errors="coerce", **options)
        except TypeError:  # dates are no lengths of time
            continue
        if moments.notna().mean() > 0.5:
            return (moments - moments.dropna().iloc[0]).dt.total_seconds()
    return None


def _numbers(cells) -> np.ndarray:
    """Cells as numbers, whole ones exactly, and NaN for what is none."""
    import pandas

    numbers = pandas.to_numeric(cells, errors="coerce")
    if numbers.dtype.kind in "iu" and not numbers.isna().any():
        return numbers.to_numpy(np.int64)
    if numbers.dtype.kind == "c":
        return np.full(len(numbers), np.nan)
    return numbers.to_numpy(float, na_value=np.nan)
