"""Tables in text files: encoding, separator, decimal sign, heads; cells as arrays by column."""

from __future__ import annotations

import bz2
import csv
import gzip
import io
import lzma
import os
import re
from dataclasses import dataclass

import numpy as np
from tqdm.auto import tqdm

_PACKED = {b"\x1f\x8b": gzip.decompress, b"BZh": bz2.decompress, b"\xfd7zXZ": lzma.decompress}
_BINARY = {
    b"PK": "a zip archive or a spreadsheet",
    b"\x89HDF": "an HDF5 file",
    b"MATLAB": "a MATLAB file",
    b"PAR1": "a Parquet file",
    b"\x93NUMPY": "a NumPy file",
    b"#ROSBAG": "a ROS bag",
}
_MARKS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe\x00\x00", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
_SEPARATORS = (";", "\t", ",", "|", " ")
_NAMES = {";": "semicolon", "\t": "tab", ",": "comma", "|": "bar", " ": "blank"}
_NUMBER = re.compile(r"[-+]?(\d+[.,]?\d*|[.,]\d+)([eE][-+]?\d+)?$")
_CHUNK = 250_000  # lines
_ABOVE = 100  # lines about a log, above its heads, at most
_LONGEST = 300  # characters of an error


@dataclass
class Table:
    """Heads, and the lines below them that hold cells."""

    path: str
    heads: list[str]  #: Empty if the file has none.
    head_line: int  #: Counted from 1, as lines are in an editor.
    lines: list[str]
    numbers: np.ndarray  #: Where each of the lines stands in the file.
    separator: str
    decimal: str | None  #: None: not known yet.
    left_out: int = 0  #: Lines with too few or too many cells.
    above: int = 0  #: Lines above the heads that are no comments.


def shown(text, most: int = 40) -> str:
    """Text as an error shows it: on one line, and cut in its middle."""
    text = " ".join(str(text).split())
    half = (most - 3) // 2
    return text if len(text) <= most else f"{text[:half]}...{text[-half:]}"


def fault(told: str, kind=ValueError) -> Exception:
    """An error of one line that nobody has to scroll."""
    return kind(shown(told, _LONGEST))


def listed(names, most: int = 120, each: int = 30) -> str:
    """Names with commas between them, as many as fit."""
    names, text = [shown(name, each) for name in names], ""
    for k, name in enumerate(names):
        longer = f"{text}, {name}" if text else name
        if len(longer) > most:
            return f"{text} and {len(names) - k} more"
        text = longer
    return text


def as_paths(paths) -> list[str]:
    """One path or several as a list of text; TypeError or ValueError otherwise."""
    several = [paths] if isinstance(paths, (str, os.PathLike)) else paths
    fine = isinstance(several, (list, tuple)) or hasattr(several, "__next__")
    several = list(several) if fine else [paths]
    if not several:
        raise ValueError("paths must name one file or more, got an empty list")
    for path in several:
        if not isinstance(path, (str, os.PathLike)) or isinstance(os.fspath(path), bytes):
            raise fault(
                f"paths must be a path or a list of paths, as text or pathlib.Path, got "
                f"{shown(repr(path))}",
                TypeError,
            )
    return [os.fspath(path) for path in several]


def read_text(path: str, encoding: str | None = None) -> str:
    """The text of a file, unpacked if it is packed; line ends are newlines."""
    name = shown(path, 100)
    if os.path.isdir(path):
        raise fault(f"{name}: is a folder; give its files, like sorted(Path(...).glob('*.csv'))",
                    IsADirectoryError)  # fmt: skip
    try:
        with open(path, "rb") as file:
            raw = file.read()
        for mark, unpack in _PACKED.items():
            if raw.startswith(mark):
                raw = unpack(raw)
    except FileNotFoundError:
        raise fault(f"{name}: no such file in {shown(os.getcwd(), 100)}",
                    FileNotFoundError) from None  # fmt: skip
    except (OSError, EOFError, ValueError, lzma.LZMAError) as error:
        raise fault(f"{name}: cannot be read: {error}", OSError) from error
    for mark, what in _BINARY.items():
        if raw.startswith(mark):
            raise fault(f"{name}: is {what}, no text; export the log as CSV")
    try:
        text = raw.decode(encoding or _encoding(raw))
    except (LookupError, UnicodeError) as error:
        raise fault(f"{name}: encoding {encoding} does not fit: {error}") from error
    if "\0" in text:
        raise fault(f"{name}: is no text file; export the log as CSV")
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def _encoding(raw: bytes) -> str:
    for mark, name in _MARKS:
        if raw.startswith(mark):
            return name
    start = raw[:1000]
    for first, name in ((1, "utf-16-le"), (0, "utf-16-be")):  # a file without its mark
        half = start[first::2]
        if len(half) > 3 and half.count(0) > 0.9 * len(half):
            return name
    try:
        raw.decode("utf-8")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8"


def split(path: str, text: str, separator, decimal, skip_bad: bool) -> Table:
    """Lines with their cells counted; a ValueError names the first with too many or too few."""
    name, every = shown(path, 100), text.split("\n")
    filled = [k for k, line in enumerate(every) if line.strip()]
    if not filled:
        raise fault(f"{name}: is empty")
    spoken = [k for k in filled if every[k].lstrip()[0] not in "#%"] or filled[-1:]
    start = _first(every, spoken, separator)
    body = [k for k in filled if k > start and every[k].lstrip()[0] not in "#%"]
    comments = [k for k in filled if k < start]
    first = every[start].strip() if not body else every[body[0]]
    sep = _separator(every[start], first) if separator is None else separator
    sep = " " if sep == r"\s+" else sep
    if _has_numbers_only(_cells(every[start], sep)):  # heads stand in a comment, or nowhere
        heads, head_line = [], start + 1
        for k in comments[-1:]:
            found = _heads(every[k].lstrip("#% \t"), sep)
            if len(found) == len(_cells(every[start], sep)):
                heads, head_line = found, k + 1
        body = [start, *body]
    else:
        _check_quotes(every[start], f"{name}, line {start + 1}")
        heads, head_line = _heads(every[start], sep), start + 1
    table = Table(path, heads, head_line, [every[k] for k in body], np.array(body, int) + 1, sep,
                  decimal, above=spoken.index(start))  # fmt: skip
    _count(table, name, skip_bad)
    return table


def _first(every, spoken, separator) -> int:
    """The line of the heads: the first, unless lines about the log stand above it."""
    seps = _SEPARATORS if separator is None else (separator,)
    for n in range(min(len(spoken) - 3, _ABOVE)):
        below = [every[k] for k in spoken[n + 1 : n + 4]]
        for sep in seps:
            heads, rows = _heads(every[spoken[n]], sep), [_cells(line, sep) for line in below]
            rows = [row[:-1] if row[len(heads) :] == [""] else row for row in rows]
            numbers = [sum(map(_is_number, row)) for row in rows]
            if 2 * min(numbers) < len(heads) or any(len(row) != len(heads) for row in rows):
                continue
            if len(heads) > 1 and (n == 0 or 2 * sum(map(_is_number, heads)) < len(heads)):
                return spoken[n]
    return spoken[0]


def _is_number(cell: str) -> bool:
    return bool(_NUMBER.match(cell))


def _separator(head: str, first: str) -> str:
    """What stands between the cells: fits the heads, and the first line below them."""
    counts = {sep: (len(_heads(head, sep)), len(_cells(first, sep))) for sep in _SEPARATORS}
    fit = [sep for sep, (heads, cells) in counts.items() if heads == cells > 1]
    several = [sep for sep, (heads, _) in counts.items() if heads > 1]
    return (fit or several or [","])[0]


def _heads(line: str, sep: str) -> list[str]:
    if sep == " ":  # a unit belongs to the name before it
        line = re.sub(r"\s+(?=[\[(])", "", line)
    return [" ".join(cell.split()) for cell in _cells(line, sep)]


def _cells(line: str, sep: str) -> list[str]:
    if sep == " ":
        line = " ".join(line.split())
    if '"' not in line:
        return [cell.strip() for cell in line.split(sep)]
    try:
        cells = next(csv.reader([line], delimiter=sep, skipinitialspace=True))
    except csv.Error:
        cells = line.split(sep)
    return [cell.strip() for cell in cells]


def _has_numbers_only(cells) -> bool:
    return all(_NUMBER.match(cell) or not cell for cell in cells) and any(cells)


def _check_quotes(line: str, place: str) -> None:
    if line.count('"') % 2:
        at = shown(line[max(line.rfind('"') - 5, 0) :])
        raise fault(f"{place}: a quote is opened and not closed on this line, at {at}")


def _count(table: Table, name: str, skip_bad: bool) -> None:
    """Refuse lines whose cells are not as many as the heads, or leave them out."""
    sep, lines = table.separator, table.lines
    if sep == " ":
        counts = [len(line.split()) for line in lines]
    else:
        counts = [line.count(sep) + 1 for line in lines]
    for k, line in enumerate(lines):
        if '"' in line:
            _check_quotes(line, f"{name}, line {table.numbers[k]}")
            counts[k] = len(_cells(line, sep))
    counts = np.array(counts, int)
    heads = len(table.heads) or (int(np.median(counts)) if counts.size else 0)
    ends = counts == heads + 1
    if (
        sep != " "
        and counts.size
        and ends.all()
        and all(x.rstrip(" ").endswith(sep) for x in lines)
    ):
        table.lines = [x.rstrip(" ")[:-1] for x in lines]  # a separator at the end of each line
        counts = counts - 1
    bad = np.flatnonzero(counts != heads)
    if not bad.size:
        return
    if skip_bad and bad.size < counts.size / 2:
        keep = np.flatnonzero(counts == heads)
        table.lines, table.numbers = [table.lines[k] for k in keep], table.numbers[keep]
        table.left_out = int(bad.size)
        return
    k = bad[0]
    cells = "1 cell" if counts[k] == 1 else f"{counts[k]} cells"
    fault_at = f"{name}, line {table.numbers[k]}: {cells} under {heads} heads"
    sample = table.lines[k]
    if sep == "," and counts[k] > heads and not re.search(r"\d\.\d", sample):
        fault_at += "; decimal commas between commas cannot be told apart: write semicolons between"
        raise fault(fault_at + " columns, or decimal points")
    if counts[k] > 1 and (counts == counts[k]).all():
        raise fault(
            f"{fault_at}, as on all lines; give the columns their heads in a copy of the file"
        )
    among = f"; between cells is taken to be a {_NAMES.get(sep, repr(sep))}, say separator= if not"
    few = "; skip_bad=True leaves such lines out" if bad.size < counts.size / 2 else among
    raise fault(fault_at + few)


def columns(table: Table, places: list[int]) -> dict[int, np.ndarray]:
    """Cells of some columns by their place: numbers if all are, else text and numbers mixed."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError("reading a log needs pandas: pip install pandas") from error
    decimal = table.decimal or _decimal(table, places)
    how = {
        "sep": r"\s+" if table.separator == " " else table.separator,
        "header": None,
        "names": range(len(_cells(table.lines[0], table.separator))),
        "usecols": sorted(set(places)),
        "index_col": False,
        "decimal": decimal,
        "skipinitialspace": True,
        "skip_blank_lines": False,
        "low_memory": False,
    }
    if tuple(map(int, pandas.__version__.split(".")[:2])) < (3, 1):
        how["float_precision"] = "round_trip"  # later versions do so by default
    parts = {place: [] for place in how["usecols"]}
    starts = range(0, len(table.lines), _CHUNK)
    for start in tqdm(starts, desc=shown(table.path), unit_scale=_CHUNK, unit=" lines", delay=3):
        text = "\n".join(table.lines[start : start + _CHUNK])
        frame = pandas.read_csv(io.StringIO(text), **how)
        for place, chunks in parts.items():
            cells = frame[place]
            chunks.append(cells.to_numpy(object if cells.dtype.kind not in "iuf" else None))
    return {place: np.concatenate(chunks) for place, chunks in parts.items()}


def _decimal(table: Table, places) -> str:
    """The decimal sign that cells of these columns have; a point if none has any."""
    if table.separator == "," and not any('"' in line for line in table.lines[:100]):
        return "."
    some = table.lines[:: max(1, len(table.lines) // 1000)]
    rows = [_cells(line, table.separator) for line in some]
    cells = [row[place] for row in rows for place in places]
    numbers = [cell for cell in cells if _NUMBER.match(cell)]
    commas = any("," in cell for cell in numbers)
    return "," if commas and not any("." in cell for cell in numbers) else "."


def cells(table: Table, line: int) -> list[str]:
    """What stands on a line, as text."""
    return _cells(table.lines[line], table.separator)


def cell(table: Table, line: int, place: int) -> str:
    """What stands in a cell, as text."""
    return cells(table, line)[place]
