"""Files that are whole or not there: nobody finds one that is half written."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from ddlib._check import told


def write_whole(path, content: str | bytes) -> None:
    """Write a file in one step, with its folder; a file that was there stays until the end."""
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"path must be a path, got {told(path)}")
    path = Path(path)
    if path.is_dir() or not path.name:
        raise ValueError(f"path must name a file, got the folder {told(str(path))}")
    path.parent.mkdir(parents=True, exist_ok=True)
    data = content.encode("utf-8") if isinstance(content, str) else content
    handle, part = tempfile.mkstemp(prefix=path.name + ".", suffix=".part", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.chmod(part, _mode(path))
        os.replace(part, path)
    except BaseException:  # an interrupt, too
        Path(part).unlink(missing_ok=True)
        raise


def _mode(path: Path) -> int:
    """Who may read and write a file: as before, or as a new file of this user."""
    if path.exists():
        return path.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
