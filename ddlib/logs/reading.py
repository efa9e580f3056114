"""Logs of a reader's own arm, from text files of any layout, and recordings to such a file."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ddlib._check import number
from ddlib.logs import _text_files as text_files, _units as known_units
from ddlib.logs._text_files import Table, fault, listed, shown
from ddlib.logs.log import Log, LoggedRecording, LoggedRun
from ddlib.logs.resampling import LogWarning, resampled
from ddlib.simulation import Recording

_ANGLES, _TORQUES = ("q1", "q2"), ("tau1", "tau2")
_MEASURED = (*_ANGLES, *_TORQUES)
_MAY_LACK = ("q2", *_TORQUES)  # 0 throughout, as in the log of a single joint
_QUANTITIES = ("time", *_MEASURED, "run")


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

    Separator, decimal sign, encoding and packing (gzip, bz2, xz) are found, unless you give them.
    Lines that are empty or begin with ``#`` or ``%`` are passed over.

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
        Units of columns that are not in s, rad, N m: ``{"time": "ms", "q1": "deg", "q2": "deg"}``.
        Known are s, ms, us, ns; rad, mrad, deg, rev; Nm, mNm, Ncm, kNm; A, mA; and a number is
        what one unit is in SI units, like ``2 * pi / 4096`` for counts of an encoder. Without it
        the head's own counts, as in "q1 [deg]", "time_ms", "tau1/Nm".
    factors : mapping, optional
        What to multiply angles and torques by, like N m/A for currents, with a sign.
    rate : float, optional
        Samples in a second, Hz, for files without a time.
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
    _check_layout(separator, decimal, encoding)
    wanted = _wanted(columns, rate, run)
    units, factors = _by_column("units", units), _by_column("factors", factors)
    if rate is not None:
        rate = number("rate", rate, 0.0, open_low=True)
    for name in (n for n in ("time", "run") if n in factors):
        raise ValueError(f"factors must be for {', '.join(_MEASURED)}, got one for {name}")
    runs, notes = [], []
    for path in text_files.as_paths(paths):
        text = text_files.read_text(path, encoding)
        table = text_files.split(path, text, separator, decimal, skip_bad)
        reader = _Reader(table, wanted, units, factors, skip_bad)
        runs += reader.runs(rate, absolute_elbow)
        notes += [f"{shown(path, 100)}: {note}" for note in reader.notes]
    return Log(tuple(runs), tuple(notes))


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
    recording, notes = resampled(log, step, longest_gap, seconds, trust_stamps)
    if notes:
        warnings.warn(notes, LogWarning, stacklevel=2)
    return recording


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

    (path,) = text_files.as_paths(path)
    if not isinstance(recording, Recording) or recording.q.ndim not in (2, 3):
        got = recording.q.shape if isinstance(recording, Recording) else type(recording).__name__
        raise TypeError(f"recording must be a Recording of one run or several, got {got}")
    q, tau = (x.reshape(-1, *recording.q.shape[-2:]) for x in (recording.q, recording.tau))
    for name, values in (("q", q), ("tau", tau)):
        if not np.isfinite(values).all():
            raise ValueError(f"recording must have finite angles and torques, got NaN in {name}")
    runs, samples, _ = q.shape
    frame = {"run": np.repeat(np.arange(1, runs + 1), samples), "time": np.tile(recording.t, runs)}
    frame |= {name: q[..., k].ravel() for k, name in enumerate(_ANGLES)}
    frame |= {name: tau[..., k].ravel() for k, name in enumerate(_TORQUES)}
    folder, name = os.path.split(os.path.abspath(path))
    with tempfile.TemporaryDirectory(dir=folder) as beside:
        whole = os.path.join(beside, name)
        pandas.DataFrame(frame).to_csv(whole, index=False, lineterminator="\n")
        os.replace(whole, path)


def _wanted(columns, rate, run) -> dict:
    """The head or place of each quantity: as given, else its own name."""
    columns = _mapping("columns", columns)
    for name in columns:
        if name not in _QUANTITIES:
            raise fault(
                f"columns must name {', '.join(_QUANTITIES)}, got {shown(repr(name))}; "
                f'write {{"q1": "its head in the file"}}'
            )
    for name, head in columns.items():
        is_place = isinstance(head, (int, np.integer)) and not isinstance(head, bool)
        if not (isinstance(head, str) or is_place or (head is None and name in _MAY_LACK)):
            raise fault(
                f"columns: {name} must be a head of the file or a place, got {shown(repr(head))}"
            )
    if run is not None:
        columns["run"] = run
    own = {name: name for name in _QUANTITIES if name != "run"}
    wanted = own | columns
    if rate is not None:
        del wanted["time"]
    return wanted


def _mapping(name: str, given) -> dict:
    if given is not None and not isinstance(given, Mapping):
        example = {"columns": "its head", "units": "deg", "factors": 0.7}[name]
        raise fault(
            f"{name} must be a dictionary, like {{'q1': {example!r}}}, got {shown(repr(given))}",
            TypeError,
        )
    return dict(given or {})


def _check_layout(separator, decimal, encoding) -> None:
    """Refuse what no file can have."""
    for name, value in {"separator": separator, "decimal": decimal, "encoding": encoding}.items():
        if not isinstance(value, str | None):
            raise TypeError(f"{name} must be text, got {shown(repr(value))}")
    if separator not in (None, r"\s+") and (len(separator) != 1 or separator in '"\n'):
        raise fault(f"separator must be one character, like ';', got {shown(repr(separator))}")
    if decimal not in (None, ".", ","):
        raise fault(f"decimal must be '.' or ',', got {shown(repr(decimal))}")


def _by_column(name: str, given) -> dict:
    """A mapping by quantity; "q" and "tau" stand for both joints."""
    by_quantity = {}
    for key, value in _mapping(name, given).items():
        both = {"q": _ANGLES, "tau": _TORQUES}.get(key, (key,))
        for quantity in both:
            if quantity not in _QUANTITIES[:-1]:
                known = ", ".join((*_QUANTITIES[:-1], "q", "tau"))
                raise fault(f"{name} must be for {known}, got {shown(repr(key))}")
            by_quantity[quantity] = value
    return by_quantity


@dataclass
class _Reader:
    """What one file says of each quantity."""

    table: Table
    wanted: dict
    units: dict
    factors: dict
    skip_bad: bool

    def __post_init__(self):
        self.notes: list[str] = []
        self.name = shown(self.table.path, 100)
        self.places, self.head_units = self._found()
        if not self.table.lines:
            raise fault(f"{self.name}: no samples below the heads")
        self.cells = text_files.columns(self.table, list(self.places.values()))
        self.rows = np.arange(len(self.table.lines))
        if self.table.above:
            self.notes.append(f"{_lines(self.table.above)} above the heads passed over.")
        if self.table.left_out:
            what = "a wrong count of cells"
            self.notes.append(f"{_lines(self.table.left_out)} with {what} left out.")

    def runs(self, rate, absolute_elbow) -> list[LoggedRun]:
        """The runs of the file, in the order of their first lines."""
        time = None if rate is not None else self._numbers("time")
        measured = {n: self._numbers(n) for n in _MEASURED if n in self.places}
        keep = np.ones(len(self.rows), bool)
        for values in (measured if time is None else {"time": time} | measured).values():
            keep &= np.isfinite(values) if values.dtype.kind == "f" else True
        if not keep.all():
            self.notes.append(f"{_lines((~keep).sum())} with a cell that is no number left out.")
        if not keep.any():
            raise fault(f"{self.name}: no line has finite numbers in all columns")
        self.rows = self.rows[keep]
        measured = {name: values[keep] for name, values in measured.items()}
        names = self.cells[self.places["run"]][self.rows] if "run" in self.places else None
        members = {self.table.path: np.arange(len(self.rows))}
        if names is not None:
            members = {}
            order, which = np.unique(names.astype(str), return_inverse=True)
            for k in np.argsort([np.argmax(which == j) for j in range(len(order))]):
                members[f"{self.table.path}, run {order[k]}"] = np.flatnonzero(which == k)
        if time is None:
            times = {name: np.arange(len(rows)) / rate for name, rows in members.items()}
        else:
            members, times = self._times(time[keep], members)
        lines = self.table.numbers[self.rows]
        q, tau = self._angles(measured, lines, absolute_elbow), self._torques(measured)
        return [
            LoggedRun(name, times[name], q[rows], tau[rows], lines[rows])
            for name, rows in members.items()
        ]

    def _found(self) -> tuple[dict[str, int], dict[str, str]]:
        """Places of the columns that are read, and the units in their heads."""
        heads, wanted = self.table.heads, dict(self.wanted)
        wanted.setdefault("run", None)
        places, units, missing = {}, {}, []
        for name, head in wanted.items():
            if isinstance(head, (int, np.integer)):
                count = len(heads) or len(self.table.lines[0].split(self.table.separator))
                if not 0 <= head < count:
                    raise fault(
                        f"columns: {name} must be a place from 0 to {count - 1}, got {head}"
                    )
                places[name] = int(head)
                if heads and name != "run":
                    units[name] = known_units.in_head(heads[head], name)[1]
            elif head is not None or name == "run":
                place = self._place(name, "run" if head is None else head)
                if place is None and (name != "run" or head is not None):
                    missing.append(head)
                elif place is not None:
                    places[name] = place
                    if name != "run" and heads[place] != head:
                        units[name] = known_units.in_head(heads[place], name)[1]
                    elif name != "run":  # named in full by its head: brackets need be no unit
                        unit = known_units.in_head(heads[place], name)[1]
                        units[name] = unit if _is_known(name, unit) else None
            else:
                self.notes.append(f"{name} is taken to be 0 throughout, as columns says.")
        if missing and not heads and len(text_files.cells(self.table, 0)) == 1:
            raise fault(
                f"{self.name}: one number on a line; a log must have a line for each time, and on "
                f"it a column for each quantity"
            )
        if missing and not heads:
            raise fault(
                f"{self.name}, line {self.table.head_line}: numbers, and no heads above them; give "
                f'columns by their places, counted from 0, like columns={{"time": 0, "q1": 1}}'
            )
        if missing:
            rate = ", or give rate=, in Hz" if missing == ["time"] else ""
            raise fault(
                f"{self.name}, line {self.table.head_line}: no column {listed(missing, 60)} in "
                f"{listed(heads, 90)}; name what it is called by columns={{...}}{rate}"
            )
        seen = {}
        for name, place in places.items():
            if place in seen:
                apart = seen[place][0] == "q" and name.startswith("tau")
                raise fault(
                    f"columns: {seen[place]} and {name} must differ, got one head for both"
                    f"{'; join files of angles and of torques by pandas.merge' if apart else ''}"
                )
            seen[place] = name
        return places, {name: unit for name, unit in units.items() if unit is not None}

    def _place(self, name: str, head: str) -> int | None:
        """Where a head stands; a ValueError if it stands in two places."""
        heads = self.table.heads
        head = " ".join(head.split())
        without = heads if name == "run" else [known_units.in_head(x, name)[0] for x in heads]
        small = [[x.lower() for x in names] for names in (heads, without)]
        for names, sought in ((heads, head), (without, head), *((x, head.lower()) for x in small)):
            places = [k for k, x in enumerate(names) if x == sought]
            if len(places) > 1:
                raise fault(
                    f"{self.name}, line {self.table.head_line}: column {shown(head)} is there "
                    f"{len(places)} times, at places {listed(places)}, counted from 0; choose by "
                    f'columns={{"{name}": {places[0]}}}'
                )
            if places:
                return places[0]
        return None

    def _numbers(self, name: str) -> np.ndarray:
        """A column as finite numbers; a ValueError names the first line that has another cell."""
        values = self.cells[self.places[name]]
        if values.dtype.kind == "O":
            import pandas

            found = pandas.to_numeric(pandas.Series(values), errors="coerce").to_numpy(float)
            if name == "time" and np.isnan(found).mean() > 0.5:
                dates = _dates(values)
                if dates is not None:
                    self.units = self.units | {"time": "ns"}
                    self.notes.append("time holds dates; it is counted from the first of them.")
                    return dates
            values = found
        bad = ~np.isfinite(values) if values.dtype.kind == "f" else np.zeros(len(values), bool)
        if bad.any() and not self.skip_bad:
            k, place = int(np.argmax(bad)), self.places[name]
            head = self.table.heads[place] if self.table.heads else f"{place} ({name})"
            text = shown(text_files.cell(self.table, k, place), 40)
            raise fault(
                f"{self.name}, line {self.table.numbers[k]}, column {shown(head)}: must be a "
                f"finite number, got {text!r}; skip_bad=True leaves such lines out"
            )
        return values

    def _unit(self, name: str):
        """The unit that was given or stands in the head, and which of these it is."""
        if name in self.units:
            return self.units[name], "given"
        return self.head_units.get(name), "head"

    def _size(self, name: str) -> tuple[float, str] | None:
        """A quantity's unit in SI units, and its kind; None if nothing tells it."""
        unit, source = self._unit(name)
        if unit is None:
            return None
        try:
            size, kind = known_units.factor(name, unit)
        except ValueError as error:
            if source == "given":
                raise
            place = f"{self.name}, line {self.table.head_line}"
            head = shown(self.table.heads[self.places[name]])
            raise fault(f"{place}: column {head}: {error}; say which by units=") from None
        is_date = name == "time" and self.cells[self.places[name]].dtype.kind == "O"
        if size != 1.0 and not is_date:
            how = "as its head says" if source == "head" else "as units says"
            written = unit if isinstance(unit, str) else f"units of {unit:g}"
            to = {"time": "s", "angle": "rad", "torque": "N m", "current": "A"}[kind]
            self.notes.append(f"{name} converted from {written} to {to}, {how}.")
        return size, kind

    def _times(self, time, members) -> tuple[dict, dict]:
        """Lines and times in s of each run."""
        members = self._parted(time, members)
        if self.skip_bad:
            members = self._forward(time, members)
        steps = np.concatenate([np.diff(time[rows]) for rows in members.values()])
        told = self._size("time")
        if told is None:
            place = (
                f"{self.name}, column {shown(self.table.heads[self.places['time']])}"
                if (self.table.heads)
                else f"{self.name}, column {self.places['time']}"
            )
            unit, since_1970 = known_units.unit_of_times(time, steps, place)
            size = known_units.factor("time", unit)[0]
            if unit != "s":
                self.notes.append(
                    f"time is in {known_units.word(unit)}, as its numbers leave no doubt; "
                    f"converted to s."
                )
        else:
            size = told[0]
            since_1970 = 6e8 <= abs(float(time[0])) * size <= 4.2e9
        if since_1970:
            time = time - time[0]  # whole numbers stay exact
        if since_1970 and self.cells[self.places["time"]].dtype.kind != "O":
            self.notes.append("time counts from 1970; the file's first time was subtracted.")
        time = known_units.converted(np.asarray(time, float), size)
        return members, {name: time[rows] for name, rows in members.items()}

    def _parted(self, time, members) -> dict:
        """Runs parted where their time begins again."""
        parted = {}
        for name, rows in members.items():
            t, parts, start = time[rows], [], 0
            for k in np.flatnonzero(np.diff(t) < 0) + 1:
                if t[k] <= t[start] + 0.1 * (t[k - 1] - t[start]) and k - start >= 3:
                    parts.append(rows[start:k])
                    start = k
            if not parts:
                parted[name] = rows
                continue
            parts.append(rows[start:])
            first = self.table.numbers[self.rows[parts[1][0]]]
            self.notes.append(
                f"time begins again at {len(parts) - 1} places, the first at line {first}; a run "
                f"begins there."
            )
            joined = ", part" if ", run " in name else ", run"
            parted |= {f"{name}{joined} {k + 1}": part for k, part in enumerate(parts)}
        return parted

    def _forward(self, time, members) -> dict:
        """Each run's lines whose time is later than all before."""
        kept, left_out = {}, 0
        for name, rows in members.items():
            t = time[rows]
            fine = np.r_[True, t[1:] > np.maximum.accumulate(t)[:-1]]
            if fine.mean() < 0.5:
                raise fault(
                    f"{shown(name, 120)}: time does not grow at {(~fine).sum()} of {len(t)} lines; "
                    f"is it the time? If runs follow each other, name their column by run="
                )
            kept[name], left_out = rows[fine], left_out + int((~fine).sum())
        if left_out:
            self.notes.append(f"{_lines(left_out)} not later than the line before left out.")
        return kept

    def _angles(self, measured, lines, absolute_elbow) -> np.ndarray:
        angles = []
        for name in _ANGLES:
            if name not in measured:
                angles.append(np.zeros(len(self.rows)))
                continue
            values, kind = self._in_si(name, measured)
            if kind is None and name not in self.factors:
                known_units.check_angle(values, self.name, name, lines)
            angles.append(self._scaled(name, values))
        if absolute_elbow:
            angles[1] = angles[1] - angles[0]
            self.notes.append("q2 was absolute; q1 was subtracted from it.")
        return np.stack(angles, -1)

    def _torques(self, measured) -> np.ndarray:
        torques = []
        for name in _TORQUES:
            if name not in measured:
                torques.append(np.zeros(len(self.rows)))
                continue
            values, kind = self._in_si(name, measured)
            if kind == "current" and name not in self.factors:
                raise fault(
                    f"{self.name}: {name} is a current, in {self._unit(name)[0]}; give its "
                    f'torque for an ampere, like factors={{"{name}": 0.7}} (N m/A)'
                )
            torques.append(self._scaled(name, values))
        return np.stack(torques, -1)

    def _in_si(self, name, measured) -> tuple[np.ndarray, str | None]:
        """A column in SI units, and the kind of its unit; None if nothing tells the unit."""
        unit, values = self._size(name), np.asarray(measured[name], float)
        return (values, None) if unit is None else (known_units.converted(values, unit[0]), unit[1])

    def _scaled(self, name, values) -> np.ndarray:
        if name not in self.factors:
            return values
        scale = number(f"factors of {name}", self.factors[name])
        if scale == 0:
            raise ValueError(f"factors of {name} must not be 0, got {scale:g}")
        self.notes.append(f"{name} multiplied by {scale:g}, as factors says.")
        return values * scale


def _is_known(quantity: str, unit: str | None) -> bool:
    try:
        known_units.factor(quantity, unit)
    except (TypeError, ValueError):
        return False
    return True


def _lines(count) -> str:
    return f"{count} line{'s' if count > 1 else ''}"


def _dates(texts) -> np.ndarray | None:
    """Dates with times of day as ns since 1970; None if they are none."""
    import pandas

    try:
        found = pandas.to_datetime(pandas.Series(texts), format="ISO8601", utc=True)
    except (ValueError, TypeError):
        return None
    if found.isna().any():
        return None
    return found.astype("datetime64[ns, UTC]").astype("int64").to_numpy()
