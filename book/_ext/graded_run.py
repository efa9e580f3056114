"""Runs one returned notebook, in a process of its own: see grade.py, which starts it.

Reads cells as JSON, and writes a line of JSON for each that has been run. It needs nothing of the
book: judge and package come from the folder where it is started.
"""

import io
import json
import sys
from contextlib import redirect_stderr, redirect_stdout
from importlib import import_module

MEMORY, LONGEST = 16 * 2**30, 10**8  # bytes; of a file that a notebook writes


class Sink(io.TextIOBase):
    """Takes whatever a cell prints, and keeps nothing of it."""

    def write(self, text):
        return len(text)


def limit():
    try:
        import resource
    except ImportError:  # Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_FSIZE, (LONGEST, LONGEST))


def stay_here():
    """Let Python's sockets reach nothing but this machine."""
    import socket

    here = ("127.0.0.1", "::1", "localhost", "", None)

    def only_here(call, of):
        def asked(*given):
            place = of(given)
            if place not in here:
                raise OSError(f"no network while a notebook is graded: {place}")
            return call(*given)

        return asked

    def named(given):
        return given[-1][0] if isinstance(given[-1], tuple) else ""  # a path is of this machine

    for name in ("connect", "connect_ex", "sendto"):
        setattr(socket.socket, name, only_here(getattr(socket.socket, name), named))
    socket.getaddrinfo = only_here(socket.getaddrinfo, lambda given: given[0])


def main(kept: str, blocked: bool):
    limit()
    sys.path.insert(0, "")
    if blocked:
        stay_here()
    import matplotlib

    matplotlib.use("Agg")
    from IPython.core.interactiveshell import InteractiveShell

    said, exercises = [], import_module("exercises")  # beside the notebook, as judge.py is
    exercises.print = lambda text: said.append(str(text))
    exercises.display = lambda waiting: said.append(repr(waiting))
    shell = InteractiveShell.instance()
    with open(kept, "a", encoding="utf-8") as file:
        for cell in json.load(sys.stdin):
            said.clear()
            with redirect_stdout(Sink()), redirect_stderr(Sink()):
                done = shell.run_cell(cell["source"])
            error = done.error_before_exec or done.error_in_exec
            told = {**cell, "said": said[-1] if said else "", "source": ""}
            told["error"] = f"{type(error).__name__}: {error}"[:300] if error else ""
            if cell["role"] == "quiz" and isinstance(shell.user_ns.get("choices"), dict):
                given = shell.user_ns["choices"].items()
                told["choices"] = {str(k): str(v).strip().upper() for k, v in given}
            file.write(json.dumps(told) + "\n")
            file.flush()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2] == "blocked")
