"""Work in threads that Ctrl-C ends soon, and that leaves what it reached."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from threading import Event


def in_threads(work: Callable, items: Sequence, most: int, stop: Event) -> tuple[list, bool]:
    """Results of ``work(item)`` in the order of the items, and whether Ctrl-C cut them short.

    On Ctrl-C, or after an error in one thread, `stop` is set; `work` must look at it often, and
    then return what it has.
    """
    interrupted, futures = False, []
    with ThreadPoolExecutor(min(most, len(items))) as pool:
        try:
            futures += (pool.submit(work, item) for item in items)
            left = set(futures)
            while left:  # Windows hears Ctrl-C only between two short waits
                done, left = wait(left, 0.2, FIRST_EXCEPTION)
                for future in done:
                    future.result()
        except KeyboardInterrupt:
            if len(futures) < len(items):
                raise
            interrupted = True
        finally:
            stop.set()
        return [future.result() for future in futures], interrupted
