"""Scripts of widgets as one text each: anywidget takes a single module."""

from __future__ import annotations

import re
from pathlib import Path

from ddlib.figures import COLOURS, FAINT, ROLES

_STATIC = Path(__file__).with_name("static")
_IMPORT = re.compile(r'^import (?:\{[^}]*\} from )?"([^"]+)";\n', re.M)


def bundle(*names: str | Path) -> str:
    """Scripts, after all that they import, each once, as one module.

    Names are of files in the folder `static`, or full paths. A script imports by ``"./other.js"``
    from its own folder, and by ``"ddlib/other.js"`` from `static`. As all stand in one module in
    the end, two scripts must not use a name for different things. Lines of comments and indentation
    are left out, so that texts of a script must stay within a line.
    """
    texts: dict[Path, str] = {}

    def add(path: Path):
        source = path.read_text(encoding="utf-8")
        for name in _IMPORT.findall(source):
            folder = _STATIC if name.startswith("ddlib/") else path.parent
            needed = folder / name.split("/", 1)[1]
            if needed not in texts:
                add(needed)
        texts[path] = re.sub(r"^export (?!default)", "", _IMPORT.sub("", source), flags=re.M)

    for name in names:
        if _STATIC / name not in texts:
            add(_STATIC / name)
    lines = (line.strip() for text in texts.values() for line in text.splitlines())
    return "\n".join(line for line in lines if line and not line.startswith("//")) + "\n"


def styles(*names: str | Path) -> str:
    """The style sheet of all widgets, then others of the folder `static` or by full paths.

    Colours are those of figures, by their roles: ``var(--even)`` and so on, and ``var(--colour)``
    in what has the class ``even`` and so on; ``c0`` and so on where there is no role.
    """
    hues = {f"c{k}": colour for k, colour in enumerate(COLOURS)}
    hues |= {role: f"light-dark({light}, {dark})" for role, (light, dark) in ROLES.items()}
    hues |= {"measured": "var(--ink)", "before": FAINT}
    own = [f".ddlib-curves .{name} {{ --colour: var(--{name}); }}" for name in hues]
    hues = "".join(f"--{name}: {value}; " for name, value in hues.items())
    sheets = [(_STATIC / name).read_text(encoding="utf-8") for name in ("curves.css", *names)]
    return "\n".join([f".ddlib-curves {{ {hues}}}", *own, *sheets])
