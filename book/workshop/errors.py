"""Errors of the book's own checks in a notebook: a reader's line and the message, no insides."""

from __future__ import annotations

import linecache
from types import TracebackType

from IPython import get_ipython

OURS = ("ddlib", "workshop", "beyond")


def short_errors() -> None:
    """From now on, where one of the book's checks refuses something, leave out the book's frames.

    Any other error is shown whole. Outside of a notebook nothing changes.
    """
    if shell := get_ipython():
        shell.set_custom_exc((Exception, KeyboardInterrupt), _shown)


def _shown(shell, kind, error, traceback, tb_offset=None) -> None:
    frames, mode = [traceback], shell.InteractiveTB.mode
    while frames[-1].tb_next:
        frames.append(frames[-1].tb_next)
    if _is_ours(frames[-1]) and _line(frames[-1]).startswith("raise "):
        traceback = None
        for at in reversed([frame for frame in frames if not _is_ours(frame)]):
            traceback = TracebackType(traceback, at.tb_frame, at.tb_lasti, at.tb_lineno)
        shell.InteractiveTB.set_mode("Plain")
    shell.showtraceback((kind, error, traceback), tb_offset=tb_offset)
    shell.InteractiveTB.set_mode(mode)


def _is_ours(at: TracebackType) -> bool:
    return at.tb_frame.f_globals.get("__name__", "").partition(".")[0] in OURS


def _line(at: TracebackType) -> str:
    return linecache.getline(at.tb_frame.f_code.co_filename, at.tb_lineno).strip()
