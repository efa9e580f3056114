"""Reference trajectories: the paper's pick-and-place family (section 2, Appendix I)."""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ddlib._check import finite_array, integer, number, seed_number, shaped
from ddlib._files import write_whole
from ddlib.paper import APPENDIX_I_EXTENTS_DEG

# The page Provenance shows constants with the notes below them.
MOTION_SECONDS = 3.0
"""Length of one pick-and-place motion, s (Appendix I)."""

MAX_EXTENT_DEG = 45.0
"""Largest extent of the family, degrees (section 2)."""

APPENDIX_I = np.array(APPENDIX_I_EXTENTS_DEG)
"""Extents of the six trajectories in degrees, shape (6, 2); the last one is the test."""
APPENDIX_I.setflags(write=False)

KEPT_IN = "picked-extents.json"
"""The file beside a reader's notebooks that holds extents of their own."""


class OutsideFamilyWarning(UserWarning):
    """The extents lie outside the square of 0 to 45 degrees that the paper draws from."""


class Trajectory(NamedTuple):
    """Positions (rad), velocities (rad/s), accelerations (rad/s^2), each ``(..., time, joint)``."""

    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray


def pick_and_place(extents_deg, t, duration: float = MOTION_SECONDS) -> Trajectory:
    """The family ``phi = -theta sin(pi t / 3)`` (Appendix I): out and back in three seconds.

    Before 0 s and from the end of the motion on the reference rests at zero, so its velocity
    jumps at both ends: by 0.82 rad/s for an extent of 45 degrees in three seconds.

    Parameters
    ----------
    extents_deg : array_like, shape (..., 2)
        Extents theta of shoulder and elbow; outside 0 to 45 with an `OutsideFamilyWarning`, and
        with a warning if they look like radians.
    t : array_like, shape (time,)
        Times, s.
    duration : float
        Length of the motion, s: the 3 of the formula.
    """
    extents_deg = finite_array("extents_deg", extents_deg, 2)
    warn_of_radians(extents_deg)
    t = shaped("t", t, "(time,)")
    number("duration", duration, 0.0, open_low=True)
    if ((extents_deg < 0) | (extents_deg > MAX_EXTENT_DEG)).any():
        warnings.warn(
            f"extents_deg outside 0 to {MAX_EXTENT_DEG:g} degrees: not of the paper's family; "
            "smooth_pick_and_place has no such limit",
            OutsideFamilyWarning,
            stacklevel=2,
        )
    theta = np.ascontiguousarray(np.moveaxis(np.deg2rad(extents_deg), -1, 0))
    omega = np.pi / duration
    moving = (t >= 0) & (t < duration * (1 - 1e-12))  # its end, whatever that rounds to
    sine, cosine = np.sin(omega * t) * moving, np.cos(omega * t) * moving
    # laid out (time, joint, runs): a simulation takes one sample of all runs at a time
    scaled = (
        np.multiply.outer(s, f * theta)
        for s, f in ((sine, -1.0), (cosine, -omega), (sine, omega**2))
    )
    return Trajectory(*(np.moveaxis(x, (0, 1), (-2, -1)) for x in scaled))


def warn_of_radians(extents_deg) -> None:
    """Warn of extents that would hardly move an arm if they were degrees, as radians do.

    They are small, each below pi, and not all of them whole numbers, as degrees often are.
    """
    extents = finite_array("extents_deg", extents_deg, 2)
    largest = np.abs(extents).max(initial=0.0)
    if 0 < largest < np.pi and (extents % 1).any():
        warnings.warn(
            f"extents_deg are {largest:.3g} degrees at most, which hardly moves an arm; if they "
            "are radians, give np.rad2deg of them",
            stacklevel=3,
        )


def random_extents(n: int, seed: int, max_deg: float = MAX_EXTENT_DEG) -> np.ndarray:
    """Extents of `n` random members of the family, degrees, shape ``(n, 2)``.

    Uniform over the square from 0 to `max_deg`, as the paper draws its six (section 2).
    """
    integer("n", n, 1)
    seed_number("seed", seed)
    number("max_deg", max_deg, 0.0, open_low=True)
    return np.random.default_rng(seed).uniform(0.0, max_deg, (n, 2))


def smooth_pick_and_place(extents_deg, t, speed: float = 1.0) -> Trajectory:
    """Out and back to the same extents, from rest to rest: ``phi = -theta sin(pi s t / 3)^2``.

    Unlike the paper's family its velocity does not jump, so that an arm can follow it. Extents
    theta are ``(..., 2)`` in degrees; the motion lasts ``3 / speed`` s, before and after it the
    reference rests. Velocities grow with the `speed` s, accelerations with its square.
    """
    warn_of_radians(extents_deg)
    shaped("t", t, "(time,)")
    number("speed", speed, 0.0, open_low=True)
    size = -np.deg2rad(finite_array("extents_deg", extents_deg, 2))[..., None, :] / 2
    t, rate = finite_array("t", t), speed * 2 * np.pi / MOTION_SECONDS
    moving = ((t >= 0) & (speed * t < MOTION_SECONDS))[:, None]
    cosine, sine = np.cos(rate * t)[:, None] * moving, np.sin(rate * t)[:, None] * moving
    return Trajectory(size * (moving - cosine), size * rate * sine, size * rate**2 * cosine)


def time_grid(step: float, rest: float = 0.0, duration: float = MOTION_SECONDS) -> np.ndarray:
    """Times of one motion with `rest` s before and after it, every `step` s.

    The motion covers the samples from 0 s, exactly, to the last before `duration`, which is
    exact, too. `step` must divide motion and rest into whole samples.
    """
    number("duration", duration, 0.0, open_low=True)
    number("step", step, 0.0, duration, open_low=True)
    number("rest", rest, 0.0)
    before, total = rest / step, (duration + 2 * rest) / step
    for name, count in (("rest", before), ("step", total)):
        if abs(count - round(count)) > 1e-6:
            raise ValueError(f"{name} must give a whole number of samples, got {count:g}")
    samples = np.arange(round(total)) - round(before)
    count = round(duration / step)
    # counted in fractions of the motion, so that its end is not one rounding below it
    return np.where(samples == count, duration, samples * duration / count)


def keep(extents_deg) -> None:
    """Keep extents of your own, for `picked` in the lessons that follow.

    They are kept only where a reader runs the cells: beside a notebook, in `KEPT_IN`; in a page
    that runs, by the browser. What runs without a reader (a build, a test, a script) keeps nothing
    and finds nothing. Appendix I's extents take the place of your own.

    Parameters
    ----------
    extents_deg : array_like, shape (motions, 2)
        Extents of shoulder and elbow, 0 to 45 degrees; four motions or more, the last is the test.
    """
    own = _family(extents_deg)
    if np.array_equal(own, APPENDIX_I):
        if _someone_is_there():
            Path(KEPT_IN).unlink(missing_ok=True)
        print("The next lessons use the extents of Appendix I.")
    elif _someone_is_there():
        write_whole(KEPT_IN, json.dumps(own.tolist()) + "\n")
        print(f"Kept: the next lessons use your {len(own)} motions.")
    else:
        print("Not kept: only a notebook or a page that you run yourself keeps extents.")


def picked() -> np.ndarray:
    """Extents that you kept (`keep`), or Appendix I's: degrees, shape ``(motions, 2)``.

    A line says so if they are your own.
    """
    path = Path(KEPT_IN)
    if not (_someone_is_there() and path.is_file()):
        return APPENDIX_I
    try:
        own = _family(json.loads(path.read_text(encoding="utf-8")))
    except (TypeError, ValueError) as error:
        print(f"Appendix I's extents, because {KEPT_IN} does not hold yours: {error}.")
        return APPENDIX_I
    own.setflags(write=False)
    print(
        f"Your own {len(own)} motions, from Trajectories. For the report's: extents = APPENDIX_I."
    )
    return own


def _family(extents_deg) -> np.ndarray:
    own = shaped("extents_deg", extents_deg, "(motions, 2)")
    if len(own) < 4:
        raise ValueError(
            "extents_deg must be 4 pairs or more, three to train on and the last one to test, got "
            f"{len(own)}"
        )
    for extent in own.flat:
        number("extents_deg", extent, 0.0, MAX_EXTENT_DEG)
    return own


def _someone_is_there() -> bool:
    """Whether a reader runs the cells: in a page, or in a notebook that could ask them something.

    What runs notebooks by itself (nbclient, and by it a build or a test) lets none of them ask.
    """
    if sys.platform == "emscripten":
        return True
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return bool(getattr(getattr(shell, "kernel", None), "_allow_stdin", False))
