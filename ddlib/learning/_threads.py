"""Work in threads, each on one core, that Ctrl-C ends soon and that leaves what it reached."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from contextlib import contextmanager
from threading import Event

import torch


@contextmanager
def one_core_each():
    """PyTorch on one core for each thread that is started inside, afterwards as it was before.

    Threads that share out their products would wait for each other at every one of them. PyTorch
    counts threads for the whole process: what runs beside this runs on one core, too, meanwhile.
    """
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def in_threads(work: Callable, items: Sequence, most: int, stop: Event) -> tuple[list, bool]:
    """Results of ``work(item)`` in the order of the items, and whether Ctrl-C cut them short.

    On Ctrl-C, or after an error in one thread, `stop` is set; `work` must look at it often, and
    then return what it has.
    """
    interrupted, futures = False, []
    # OpenMP asks each thread anew
    pool = ThreadPoolExecutor(
        min(most, len(items)), initializer=torch.set_num_threads, initargs=(1,)
    )
    with one_core_each(), pool:
        try:
            futures += (pool.submit(work, item) for item in items)
            pending = set(futures)
            while pending:  # Windows hears Ctrl-C only between two short waits
                done, pending = wait(pending, 0.2, FIRST_EXCEPTION)
                for future in done:
                    future.result()
        except KeyboardInterrupt:
            if len(futures) < len(items):
                raise
            interrupted = True
        finally:
            stop.set()
        return [future.result() for future in futures], interrupted
