"""Sections 2 and 4 and Appendix I: the family, its members, the recordings, what they cover."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import Delaunay
from scipy.stats import binom

from ddlib import paper
from ddlib.analysis import cells_reached, log10_reachable_share, used_dimensions
from ddlib.control import proportional
from ddlib.learning import sliding_windows
from ddlib.paper import TRAINING_TRAJECTORIES
from ddlib.setups import KP, POSITION_FEEDBACK, SETUPS, STATE_FEEDBACK, WINDOWS, true_states
from ddlib.simulation import LOG_STEP, Recording, rms
from ddlib.tables import scientific, significant
from ddlib.trajectories import (
    APPENDIX_I,
    MAX_EXTENT_DEG,
    MOTION_SECONDS,
    pick_and_place,
    random_extents,
    time_grid,
)
from workshop.report import committed
from workshop.report.evidence.verdicts import Measured, turns_at
from workshop.report.exact_states import RADIUS

_TRAINING = len(TRAINING_TRAJECTORIES)


def ends_and_middle() -> Measured:
    """Whether all six begin and end at zero and have their extents half-way, in size."""
    middle = np.rad2deg(pick_and_place(APPENDIX_I, [0.0, MOTION_SECONDS / 2]).q)
    ends = np.abs(pick_and_place(APPENDIX_I, [0.0, MOTION_SECONDS - 1e-9]).q).max()
    holds = ends < 1e-8 and np.allclose(middle[:, 1], -APPENDIX_I)
    text = "0° at 0 s and 3 s, the extent half-way; the formula's sign turns both joints the "
    text += "negative way"
    return Measured(bool(holds), text)


def members() -> Measured:
    """Whether all six pairs of extents lie in the square; where the test lies."""
    inside = ((APPENDIX_I >= 0) & (APPENDIX_I <= MAX_EXTENT_DEG)).all()
    hull = Delaunay(APPENDIX_I[:_TRAINING])
    draws = random_extents(2000 * (_TRAINING + 1), seed=3).reshape(2000, _TRAINING + 1, 2)
    outside = np.mean([Delaunay(d[:-1]).find_simplex(d[-1]) < 0 for d in draws])
    place = "outside" if hull.find_simplex(APPENDIX_I[-1]) < 0 else "inside"
    text = f"six of six; number {paper.TEST_TRAJECTORY} lies {place} the hull of the others, as in "
    text += f"{100 * outside:.0f} % of random draws"
    return Measured(bool(inside), text)


def random_draws(resolution: float = 0.1) -> Measured:
    """Chance that uniform draws put as many of the extents on a limit as are there."""
    on_limit = int(np.isin(APPENDIX_I, (0.0, MAX_EXTENT_DEG)).sum())
    chance = binom.sf(on_limit - 1, APPENDIX_I.size, resolution / MAX_EXTENT_DEG)
    text = f"{on_limit} of {APPENDIX_I.size} extents lie on a limit; uniform draws do that with "
    text += f"a chance of {scientific(chance)}"
    return Measured(float(chance), text)


def samples() -> Measured:
    """Samples of one motion in the log."""
    recording = committed.recording()
    count = recording.t[recording.motion].size
    return Measured(count, f"{count} at {1 / LOG_STEP:.0f} a second")


def cases() -> Measured:
    """Windows of the five training recordings: with the rests, and inside the motions."""
    recording = committed.recording()
    found = [
        sliding_windows(recording.q[:_TRAINING], w, recording.motion)[..., 0, 0].size
        for w in WINDOWS
    ]
    inside = [
        sliding_windows(recording.q[:_TRAINING, recording.motion], w)[..., 0, 0].size
        for w in WINDOWS
    ]
    text = f"{found[0]:,} with the rests; windows within the motions give "
    text += ", ".join(f"{n:,}" for n in inside)
    return Measured(found[0], text)


def period() -> Measured:
    """Period of the sine in Appendix I, s, from the zero crossings of its formula."""
    reference = pick_and_place([MAX_EXTENT_DEG] * 2, time_grid(LOG_STEP))
    rate = np.sqrt(-np.polyfit(reference.q[:, 0], reference.qdd[:, 0], 1)[0])
    seconds = float(2 * np.pi / rate)
    return Measured(seconds, f"{seconds:.1f} s; the motion lasts half of it")


def start() -> Measured:
    """Speed of the reference at its first sample over its largest speed."""
    speed = np.abs(pick_and_place([MAX_EXTENT_DEG] * 2, time_grid(LOG_STEP)).qd[:, 0])
    text = f"starts at {speed[0]:.2f} rad/s for an extent of {MAX_EXTENT_DEG:g}°, its largest speed"
    return Measured(float(speed[0] / speed.max()), text)


def _missed(recording: Recording) -> float:
    """RMS tracking error over RMS angle on the six motions."""
    error, wanted = recording.tracking_error, recording.reference.q
    return float(np.divide(*(rms(x[:, recording.motion], None) for x in (error, wanted))))


def driven(close: float = 0.1, factors=(1, 2, 3)) -> Measured:
    """Multiple of the assumed gains from which on position feedback alone follows closely."""

    def missed(factor):
        gains = tuple(factor * np.array(KP))
        return _missed(replace(POSITION_FEEDBACK, controller=proportional(gains)).record())

    position, state = (
        _missed(committed.recording(s.name)) for s in (POSITION_FEEDBACK, STATE_FEEDBACK)
    )
    turn = turns_at(factors, [position, *map(missed, factors[1:])], close)
    text = f"RMS error {100 * position:.0f} % of the angle by position feedback, "
    text += f"{100 * state:.0f} % by state feedback; {100 * close:g} % from "
    text += f"{significant(turn, 2)} times the assumed gains on"
    return Measured(float(turn), text)


def unreachable(width: int = 21) -> Measured:
    """Upper bound on the reachable share of the windows' cube, as a power of ten."""
    power = 2 * log10_reachable_share(width, RADIUS * LOG_STEP / np.pi)
    recording = committed.recording()
    windows = sliding_windows(recording.q[:_TRAINING], width, recording.motion)
    step = STATE_FEEDBACK.effects.encoder[0].step
    used = used_dimensions(windows.reshape(-1, 2 * width), step)
    share = scientific(10.0 ** np.ceil(power))
    text = f"a share below {share} (window {width}, speeds up to {RADIUS:.2f} "
    text += f"rad/s); the recordings use {used} of {2 * width} dimensions"
    return Measured(float(power), text)


def _states(setup: str) -> np.ndarray:
    """True states of the training runs, ``(runs, samples, 2, 3)``."""
    return true_states(committed.recording(setup)[:_TRAINING], SETUPS[setup])


def coverage(cells: int = 10) -> Measured:
    """Share of the cells of section 6's cube that the training recordings reach."""
    shares = {}
    for name in SETUPS:
        states = _states(name).reshape(-1, 6)
        shares[name] = cells_reached(states, RADIUS, cells) / cells**6
    text = f"of {cells**6:,} cells " + ", ".join(
        f"{100 * x:.2g} % ({n})" for n, x in shares.items()
    )
    return Measured(max(shares.values()), text)
