"""Text files as frames, whatever their packing, encoding, separators and heads."""

from __future__ import annotations

import bz2
import csv
import gzip
import io
import lzma
import zlib
from collections import Counter
from dataclasses import dataclass, field
from itertools import zip_longest

import numpy as np

from ddlib.logs._units import are_units
from ddlib.tables import plural

_LONGEST = 300  # characters of an error
_WIDEST = 20_000  # characters of a line
_LARGEST = 10**9  # bytes of a file
_SWELLS = 100  # times its size that a packed file may hold, if that is more than 10 MB
_PACKED = {b"\x1f\x8b": gzip.open, b"BZh": bz2.open, b"\xfd7zXZ": lzma.open}
_MARKS = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
_SEPARATORS = {";": "semicolons", "\t": "tabs", ",": "commas", "|": "bars", " ": "blanks"}
_BLANK = ' \t;,|"=-+#%'  # what lines without cells consist of
_NOT_TEXT = (  # first bytes, end of the name, and what to do with such a file
    (b"PK", ".npz", "read_frame(numpy.load(path)) reads it"),
    (b"PK", ".xlsx", "read_frame(pandas.read_excel(path)) reads it"),
    (b"PK", "", "it is a zip archive; unpack it"),
    (b"\xd0\xcf\x11\xe0", "", "read_frame(pandas.read_excel(path)) reads it"),
    (b"MATLAB 5.0", "", "read_frame(scipy.io.loadmat(path)) reads it"),
    (b"\x89HDF", "", "read_frame takes its arrays by name, as h5py.File(path) has them"),
    (b"PAR1", "", "read_frame(pandas.read_parquet(path)) reads it"),
    (b"{", "", "read_frame(pandas.read_json(path)) reads it; lines=True if each line is a record"),
    (b"[", ".json", "read_frame(pandas.read_json(path)) reads it"),
    (b"#ROSBAG", "", "read_log reads what rostopic echo -b FILE -p TOPIC > log.csv writes"),
    (b"SQLite", "", "if it is a ROS bag, read_frame takes the arrays that package rosbags reads"),
    (b"\x89MCAP", "", "read_frame takes the arrays that package rosbags reads from it"),
)
_LOG = "a log must have a line for each time, and on it a column for each quantity"


def shortened(text, most: int = 40) -> str:
    """Text on one line, without its middle if it is long."""
    text = " ".join(str(text).split())
    half = (most - 3) // 2
    return text if len(text) <= most else f"{text[:half]}...{text[-half:]}"


def fault(message: str, kind=ValueError) -> Exception:
    """An error on one line that nobody has to scroll."""
    return kind(shortened(message, _LONGEST))


@dataclass
class Table:
    """A log as a frame of pandas: its columns are the heads, its index the lines."""

    path: str
    frame: object  #: Columns are places, if there are no heads.
    where: str  #: File and line of the heads, for errors.
    row: str = "line"  #: What the index counts.
    misfits: int = 0  #: Rows of NaN, for lines that had too few cells or too many.
    notes: list[str] = field(default_factory=list)


def read_text(path: str, separator, decimal, encoding, skip_bad: bool) -> Table:
    """A text file as a table; a ValueError names the line that does not fit."""
    name = shortened(path, 100)
    lines = _decoded(path, name, encoding).split("\n")
    filled = [k for k, line in enumerate(lines) if line.strip(_BLANK)]
    if not filled:
        raise fault(f"{name}: is empty")
    longest = max(filled, key=lambda k: len(lines[k].strip(_BLANK)))
    if len(lines[longest].strip(_BLANK)) > _WIDEST:
        raise fault(f"{name}, line {longest + 1}: has more than {_WIDEST:,} characters; {_LOG}")
    spoken = [k for k in filled if lines[k].lstrip()[0] not in "#%"]
    sample = [lines[k] for k in spoken[:: len(spoken) // 100 + 1]]
    given = " " if separator == r"\s+" else separator
    sep, usual = _layout(sample, _SEPARATORS if given is None else [given])
    parted = f"if cells are not parted by {_SEPARATORS.get(sep, repr(sep))}, say separator="
    if usual[1] < 2:
        raise fault(f"{name}: has no line of two numbers; {_LOG}; {parted}")
    start = next(k for k in spoken if _shape(_cells(lines[k], sep)) == usual)
    heads, used = _heads(lines, [k for k in filled if k < start], sep, _cells(lines[start], sep))
    body = [k for k in spoken if k >= start or (used and k > used[-1])]
    rows = [lines[k] for k in body]
    width = max(usual[0], len(heads))
    least = min(usual[0], len(heads) or width)
    misfits = [k for k, row in enumerate(rows) if not _fits(row, sep, least, width)]
    few = len(misfits) < len(rows) / 2
    if misfits and not (skip_bad and few):
        raise fault(
            f"{name}, line {body[misfits[0]] + 1}: {len(_cells(rows[misfits[0]], sep))} cells, "
            f"where {width} are usual; {'skip_bad=True leaves such lines out' if few else parted}"
        )
    for k in misfits:
        rows[k] = "nan"
    frame = _frame(rows, sep, decimal or _decimal(sample, sep), width)
    where = f"{name}, line {(used or [start])[0] + 1}"
    heads += [""] * (width - len(heads)) if heads else range(width)
    frame = frame.set_axis(heads, axis=1).set_axis(np.array(body) + 1)
    table = Table(path, frame, where, misfits=len(misfits))
    if passed := len(filled) - len(body) - len(used):
        table.notes.append(
            f"{plural(passed, 'line')} above the heads or with a remark passed over."
        )
    return table


def _decoded(path: str, name: str, encoding: str | None) -> str:
    """The text of a file, unpacked if it is packed; line ends are newlines."""
    most = _LARGEST
    try:
        with open(path, "rb") as file:
            raw = file.read(most + 1)
        for mark, unpack in _PACKED.items():
            if raw.startswith(mark):
                most = max(10**7, min(most, _SWELLS * len(raw)))
                with unpack(io.BytesIO(raw)) as file:
                    raw = file.read(most + 1)
                break
    except (OSError, EOFError, lzma.LZMAError, zlib.error) as error:
        kind = type(error) if isinstance(error, OSError) else OSError
        raise fault(f"{name}: cannot be read: {error}", kind) from error
    if len(raw) > most:
        raise fault(f"{name}: holds more than {most / 1e6:,.0f} MB; cut it into parts")
    for mark, end, advice in _NOT_TEXT:
        if raw[:100].lstrip().startswith(mark) and path.lower().endswith(end):
            raise fault(f"{name}: is no table of text; {advice}")
    try:
        text = raw.decode(encoding or _encoding(raw))
    except (LookupError, UnicodeError) as error:
        raise fault(f"{name}: encoding {encoding} does not fit: {error}") from error
    if "\0" in text:
        raise fault(f"{name}: is no text file; read_frame takes frames of pandas and arrays")
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def _encoding(raw: bytes) -> str:
    """utf-8, or what the first bytes say, or else latin-1, which every file could be."""
    for mark, name in _MARKS.items():
        if raw.startswith(mark):
            return name
    if raw[1:1000:2].count(0) > 0.9 * len(raw[1:1000:2]) > 0:
        return "utf-16-le"  # without its mark
    try:
        raw.decode("utf-8")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8"


def _layout(sample: list[str], separators) -> tuple[str, tuple[int, int, int]]:
    """What stands between cells, and the shape of most lines: of those with most numbers."""
    layouts = [(",", (0, 0, 0), 0)]
    for sep in separators:
        shapes = Counter(_shape(_cells(line, sep)) for line in sample)
        layouts += [(sep, shape, count) for shape, count in shapes.items()]
    sep, shape, _ = max(layouts, key=lambda x: (x[2] * x[1][1], -x[2] * x[1][2]))
    return sep, shape


def _heads(lines, above, sep, first) -> tuple[list[str], list[int]]:
    """Heads above the `first` row, with units below them, and the lines in which they stand."""
    units, used = [], []
    for k in reversed(above):
        line = lines[k].strip() if sep == " " else lines[k]
        row = _cells(line.lstrip("#% \t") if line.lstrip()[0] in "#%" else line, sep)
        if sep == " " and len(row) != len(first):  # a unit belongs to the name before it
            joined = " ".join(row).replace(" [", "[").replace(" (", "(").replace("N m", "Nm")
            row = _cells(joined, sep)
        while row and not row[-1]:
            row.pop()
        unnamed, unfilled = any(first[len(row) :]), len(row) > len(first)
        if unnamed or (unfilled and sep == " ") or 2 * _numbers(row) > _numbers(first):
            continue
        row = [" ".join(head.split()) for head in row]
        if used or not are_units(row):
            pairs = zip_longest(row, units, fillvalue="")
            return [f"{head} [{unit}]" if unit else head for head, unit in pairs], [k, *used]
        units, used = [unit.strip("[]()") for unit in row], [k]
    return [f"[{unit}]" if unit else "" for unit in units], used


def _fits(row: str, sep: str, named: int, width: int) -> bool:
    """Whether a row has as many cells as heads; empty ones at its end do not count."""
    count = len(row.split()) if sep == " " else row.count(sep) + 1
    if '"' not in row and named <= count <= width:
        return True
    cells = _cells(row, sep)
    whole = row.count('"') % 2 == 0 and '"' not in "".join(cells)
    return whole and len(cells) >= named and not any(cells[width:])


def _frame(rows, sep, decimal, width):
    """Rows as a frame of pandas: numbers where all cells of a column are, else texts."""
    import pandas

    exact = {}
    if tuple(map(int, pandas.__version__.split(".")[:2])) < (3, 1):
        exact["float_precision"] = "round_trip"  # later versions need not be told
    return pandas.read_csv(
        io.BytesIO("\n".join([sep.join(map(str, range(width))), *rows]).encode()),
        sep=r"\s+" if sep == " " else sep,
        decimal=decimal,
        usecols=range(width),
        index_col=False,
        skipinitialspace=True,
        skip_blank_lines=False,
        low_memory=False,
        **exact,
    )


def _decimal(sample, sep) -> str:
    """A comma, if more numbers have one than a point."""
    numbers = [cell for line in sample for cell in _cells(line, sep) if _is_number(cell)]
    commas, points = (sum(sign in cell for cell in numbers) for sign in ",.")
    return "," if commas > points else "."


def _cells(line: str, sep: str) -> list[str]:
    """The cells of a line, without blanks around them."""
    if sep == " ":
        line = " ".join(line.split())
    if '"' in line:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=sep))]
    return [cell.strip() for cell in line.split(sep)]


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", ".", 1))
    except ValueError:
        return False
    return True


def _numbers(row: list[str]) -> int:
    """How many cells of a row are numbers."""
    return sum(map(_is_number, row))


def _shape(row: list[str]) -> tuple[int, int, int]:
    """How many cells a row has, how many are numbers, and how many are something else."""
    numbers = _numbers(row)
    return len(row), numbers, len(row) - row.count("") - numbers
