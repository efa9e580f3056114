"""Notebooks executed ahead of the build, on all cores.

Each has a kernel of its own. On Linux that is forked from a process that has imported the large
libraries, which saves the two or three seconds that a fresh one needs for them.
"""

from __future__ import annotations

import gc
import multiprocessing
import multiprocessing.forkserver
import os
import sys
import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

# What takes long to import is imported where it is needed: kernels read this module, too.

TIMEOUT = 600  # seconds for one cell, as in _config.yml
HERE = os.pathsep.join(map(str, Path(__file__).parents[:2]))
PATHS = "PYTHONPATH"
PAUSE = 10  # seconds between two lines of progress
FEW = 4  # notebooks, for which a process to fork from is not worth its start
PRELOADED = (
    "ipykernel.kernelapp",
    "anywidget",
    "control",
    "matplotlib.figure",
    "sympy",
    "torch",
    "workshop.report.measures",
    "workshop.report.evidence.wall",
    "ddlib.figures.style",
    "ddlib.widgets.base",
    "warm",
)


def execute(cache, paths: list[Path], say=print) -> tuple[list[Path], list[Path]]:
    """Execute those notebooks, in their order, that the cache does not know, and keep them there.

    Parameters
    ----------
    cache : jupyter_cache.base.JupyterCacheAbstract
    paths : list of Path
        Of notebooks.
    say : callable
        Called with a line of progress every `PAUSE` seconds or so, and at the end.

    Returns
    -------
    done, ended : list of Path
        Notebooks that are in the cache now; those whose kernel ended. What fails in a cell is
        in neither, and not kept.
    """
    import nbformat
    from jupyter_cache.base import CacheBundleIn
    from jupyter_cache.executors.utils import single_nb_execution

    running = []

    def run(path: Path):
        running.append(path.stem)
        notebook = nbformat.read(path, as_version=4)
        try:
            return path, single_nb_execution(notebook, str(path.parent), TIMEOUT, False)
        except Exception as error:  # the kernel died: whatever this is, the build goes on
            print(f"{path}: {error!r}", file=sys.stderr)
            return path, None
        finally:
            running.remove(path.stem)

    known = {Path(record.uri) for record in map(cache.add_nb_to_project, map(str, paths))}
    known -= {Path(record.uri) for record in cache.list_unexecuted()}
    todo = [path for path in paths if path not in known]
    done, ended = [], []
    begun = said = time.monotonic()
    # one more than cores: a kernel that starts or ends mostly waits
    with forked_kernels(len(todo) > FEW), ThreadPoolExecutor(os.cpu_count() + 1) as pool:
        left = {pool.submit(run, path) for path in todo}
        while left:
            over, left = wait(left, PAUSE, FIRST_COMPLETED)
            for path, result in (task.result() for task in over):
                if result is None:
                    ended.append(path)
                elif result.err is None:
                    spent = {"execution_seconds": result.time}
                    bundle = CacheBundleIn(result.nb, str(path), data=spent)
                    cache.cache_notebook_bundle(bundle, check_validity=False, overwrite=True)
                    done.append(path)
            now = time.monotonic()
            if now - said >= PAUSE or not left:
                said, count = now, len(todo) - len(left)
                at = f": {', '.join(running)}" if left else ""
                say(f"    {count} of {len(todo)} notebooks after {now - begun:.0f} s{at}")
    return done, ended


@contextmanager
def forked_kernels(wanted: bool = True) -> Iterator[None]:
    """Kernels start by a fork, where that is safe and wanted."""
    if not wanted or sys.platform != "linux":
        yield
        return
    from jupyter_client.provisioning import local_provisioner

    os.environ.setdefault("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    server = multiprocessing.get_context("forkserver")
    server.set_forkserver_preload(list(PRELOADED))
    usual = local_provisioner.launch_kernel

    def launch(command, env=None, cwd=None, **options):
        return Forked(server, command[command.index("-f") + 1], env, cwd)

    # a process that starts would import the main module: without a file there is none
    main, sys.modules["__main__"] = sys.modules["__main__"], ModuleType("__main__")
    local_provisioner.launch_kernel = launch
    start_importing()
    try:
        yield
    finally:
        local_provisioner.launch_kernel = usual
        sys.modules["__main__"] = main


def start_importing() -> None:
    """Let the server import before the first kernel asks, from the book's folders as well."""
    known = os.environ.get(PATHS)
    os.environ[PATHS] = os.pathsep.join(filter(None, (HERE, known)))
    multiprocessing.forkserver.ensure_running()
    del os.environ[PATHS]
    if known:
        os.environ[PATHS] = known


class Forked:
    """A forked kernel with the part of `subprocess.Popen` that kernels' managers use."""

    stdin = stdout = stderr = None

    def __init__(self, server, connection_file: str, env: dict, cwd: str):
        here, there = server.Pipe()
        self.process = server.Process(target=kernel, args=(connection_file, env, cwd, there))
        self.process.start()
        here.recv()  # it leads a session of its own: signals to it reach nobody else
        self.pid = self.process.pid

    def poll(self) -> int | None:
        return self.process.exitcode

    def wait(self) -> int | None:
        self.process.join()
        return self.process.exitcode

    def send_signal(self, number: int) -> None:
        os.kill(self.pid, number)

    def kill(self) -> None:
        self.process.kill()

    def terminate(self) -> None:
        self.process.terminate()


def kernel(connection_file: str, env: dict, cwd: str, ready) -> None:
    """What the forked process does."""
    os.setsid()
    ready.send(os.getpid())
    os.chdir(cwd)
    os.environ.pop(PATHS, None)  # that of the server
    os.environ.update(env)
    parent = f"--IPKernelApp.parent_handle={os.getppid()}"  # it ends if that one does
    sys.argv[:] = ["ipykernel_launcher", "-f", connection_file, parent]
    sys.path[:] = [folder for folder in sys.path if folder != HERE]
    from ipykernel.kernelapp import launch_new_instance

    gc.freeze()  # what was imported is never garbage
    gc.set_threshold(20_000, 20, 100)  # figures make many small objects and drop them at once
    launch_new_instance()
