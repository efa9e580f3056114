"""Families of motions beside Appendix I: circles of the hand, and several via points."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from itertools import product

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.spatial import cKDTree

from beyond.rivals.protocol import Cases
from beyond.studies.loop.feedforwards import on_days
from ddlib.analysis import cells_reached
from ddlib.dynamics import Arm, follow_hand
from ddlib.setups import Setup, true_states
from ddlib.simulation import CONTROL_STEP, LOG_STEP, REST, Recording, follow
from ddlib.trajectories import (
    APPENDIX_I,
    MAX_EXTENT_DEG,
    MOTION_SECONDS,
    Trajectory,
    pick_and_place,
    random_extents,
    time_grid,
)

# 1,500 cases each; "both": every second case of the first two
FAMILIES = ("pick and place", "circles", "both", "via points")
_VIA, MOST = 3, 6  # via points of the training motions, and most that are tested
_LEG = 1.5  # s, from point to point of steady motions
RADIUS = (0.04, 0.12)  # m
PERIOD = (1.5, 3.0)  # s, of a turn
DISTANCE = (0.55, 0.75)  # m, of the centres: the hand comes within 0.43 to 0.87 m
BEARING = (-80.0, -40.0)  # degrees, of the centres

# Circles within the angles of pick-and-place, where only the way the joints move is new.
_SMALL = {"radius": (0.01, 0.025), "distance": (0.86, 0.865), "bearing_deg": (-50.0, -25.0)}
CELLS = 6  # along each axis of the states

# Parts of a state: position, velocity and acceleration of the shoulder, then of the elbow.
_AXES = {
    "positions": [0, 3],
    "velocities": [1, 4],
    "accelerations": [2, 5],
    "positions and velocities": [0, 1, 3, 4],
    "all": list(range(6)),
}

TEST_DAY = 1000  # seed of all tests: noise and members
_RAMP = 0.5  # s, of a smooth start or end


@dataclass(frozen=True)
class Circles:
    """Circles of the hand: "extents" of a family, arrays of one value for each member."""

    radius: np.ndarray  # m
    period: np.ndarray  # of one turn, s
    distance: np.ndarray  # of the centre from the shoulder, m
    bearing_deg: np.ndarray  # of the centre, degrees from the x axis
    clockwise: np.ndarray  # bool

    def __len__(self):
        return len(self.radius)

    def __getitem__(self, runs) -> Circles:
        """Some of the members: a slice or an array of indices."""
        return Circles(*(getattr(self, field.name)[runs] for field in fields(self)))

    @property
    def centre(self) -> np.ndarray:
        """Centres of the circles, from the shoulder, m, shape (runs, 2)."""
        angle = np.deg2rad(self.bearing_deg)
        return self.distance[:, None] * np.stack([np.cos(angle), np.sin(angle)], -1)


def random_circles(runs: int, seed: int) -> Circles:
    """Members of the family, each quantity uniform in its range, either way round."""
    draw = np.random.default_rng(seed)
    ranges = (RADIUS, PERIOD, DISTANCE, BEARING)
    return Circles(*(draw.uniform(*r, runs) for r in ranges), draw.random(runs) < 0.5)


def _pace(t, start: str = "jump") -> np.ndarray:
    """Time as a motion sees it, with two derivatives; speed jumps, or rises within `_RAMP`."""
    inside = np.clip(t, 0.0, MOTION_SECONDS)
    if start == "jump":
        moving = (t >= 0) & (t < MOTION_SECONDS * (1 - 1e-12))
        return np.stack([inside, 1.0 * moving, np.zeros(t.size)])
    up, down = (np.clip(x / _RAMP, 0.0, 1.0) for x in (inside, MOTION_SECONDS - inside))
    # speed u^2 (3 - 2 u) in a ramp: its integral is u^3 - u^4 / 2
    gone = _RAMP * (up**3 - up**4 / 2) + np.clip(inside - _RAMP, 0, MOTION_SECONDS - 2 * _RAMP)
    gone += _RAMP * (0.5 - down**3 + down**4 / 2)
    change = (6 * up * (1 - up) - 6 * down * (1 - down)) / _RAMP
    return np.stack([gone, np.minimum(up, down) ** 2 * (3 - 2 * np.minimum(up, down)), change])


def stirred(
    arm: Arm, circles: Circles, t, elbow: str = "negative", start: str = "jump"
) -> Trajectory:
    """References ``(runs, time, 2)``, each from its circle's farthest point from the shoulder.

    The motion is from 0 to `MOTION_SECONDS`; ``elbow`` is the sign of its angle, negative in
    pick-and-place, and ``start`` is "jump", as in Appendix I, or "smooth", after a ramp.
    """
    turning = np.where(circles.clockwise, -1, 1) * 2 * np.pi / circles.period
    angle, rate, change = turning[:, None] * _pace(t, start)[:, None]
    first = np.deg2rad(circles.bearing_deg)[:, None]
    return _around(arm, circles.centre, circles.radius, (first + angle, rate, change), elbow)


def _around(arm: Arm, centre, radius, phase, elbow: str = "positive") -> Trajectory:
    """Joint motion of the hand on circles, its `phase` (rad) with two derivatives (runs, time)."""
    angle, rate, change = (x[..., None] for x in phase)
    along = np.concatenate([np.cos(angle), np.sin(angle)], -1)
    across = np.concatenate([-np.sin(angle), np.cos(angle)], -1)
    size = radius[..., None, None]
    places = centre[..., None, :] + size * along
    pull = size * (change * across - rate**2 * along)
    return follow_hand(arm, places, size * rate * across, pull, elbow)


def _via_points(points, t, seconds: float = MOTION_SECONDS) -> Trajectory:
    """From rest at zero through points, rad, and back, by quintic splines; equal times."""
    y = np.pad(points, ((0, 0), (1, 1), (0, 0))).swapaxes(0, 1)
    rest = [(k, np.zeros(y.shape[1:])) for k in (1, 2)]
    spline = make_interp_spline(np.linspace(0, seconds, len(y)), y, 5, bc_type=(rest, rest))
    moving = ((t >= 0) & (t <= seconds))[:, None, None]
    inside = np.clip(t, 0.0, seconds)
    return Trajectory(*((spline(inside, k) * moving).swapaxes(0, 1) for k in range(3)))


def _random_points(runs: int, points: int, seed: int) -> np.ndarray:
    """Via points ``(runs, points, 2)``, rad, uniform over the angles of pick-and-place."""
    draw = np.random.default_rng(seed)
    return -np.deg2rad(draw.uniform(0.0, MAX_EXTENT_DEG, (runs, points, 2)))


def times(seconds: float = MOTION_SECONDS) -> np.ndarray:
    """Times of the control samples of a motion with its rests, s."""
    return time_grid(CONTROL_STEP, REST, seconds)


def recorded(
    setup: Setup, reference: Trajectory, seconds: float = MOTION_SECONDS, controller=None, seed=None
) -> Recording:
    """Drive the arm of a set-up along references at `times`, and log what its sensors say."""
    return follow(
        setup.arm,
        setup.controller if controller is None else controller,
        reference,
        times(seconds),
        effects=setup.effects,
        seed=setup.seed if seed is None else seed,
        log_every=round(LOG_STEP / CONTROL_STEP),
        duration=seconds,
    )


def training_cases(runs: dict[str, Recording], width: int) -> dict[str, Cases]:
    """Windows of each of `FAMILIES`, from recordings by name: the same number of cases."""
    cases = {name: Cases.windows(run, width) for name, run in runs.items()}
    halves = [cases[name] for name in ("pick and place", "circles")]
    x, torque = (np.concatenate([getattr(c, n)[::2] for c in halves]) for n in ("x", "torque"))
    cases["both"] = Cases(x, torque, "windows", LOG_STEP)
    return {name: cases[name] for name in FAMILIES}


def _small_circles(runs: int, seed: int) -> Circles:
    """Members with the ranges of `_SMALL` in place of the family's."""
    whole, draw = random_circles(runs, seed), np.random.default_rng((seed, 1))
    return replace(whole, **{name: draw.uniform(*r, runs) for name, r in _SMALL.items()})


def test_recordings(setup: Setup, members: int, vias: bool = True) -> dict[str, Recording]:
    """Recordings of the tests: another draw of each family, and what lies beyond both."""
    today, t, arm = setup.repeated(TEST_DAY), times(), setup.arm
    circles = random_circles(members, TEST_DAY)
    references = {
        "circles": stirred(arm, circles, t),
        "circles, smooth start": stirred(arm, circles, t, start="smooth"),
        "circles, other elbow": stirred(arm, circles, t, "positive"),
        "small circles": stirred(arm, _small_circles(members, TEST_DAY), t),
    }
    recordings = {
        "pick and place": today.record(random_extents(members, TEST_DAY)),
        "trajectory 6": today.record(APPENDIX_I[5:]),
        **{name: recorded(today, reference) for name, reference in references.items()},
    }
    for number in range(1, MOST + 1) if vias else ():
        points, seconds = _random_points(members, number, TEST_DAY), _LEG * (number + 1)
        recordings[f"{number} via points"] = recorded(today, _via_points(points, t))
        steady = _via_points(points, times(seconds), seconds)
        recordings[f"{number} via points, steady"] = recorded(today, steady, seconds)
    return recordings


def states(recording: Recording, setup: Setup) -> np.ndarray:
    """Every fifth true state of a recording's motions, shape (states, 6), as in `_AXES`."""
    return true_states(recording, setup)[:, ::5].reshape(-1, 6)


def _nearest_distances(points, among) -> np.ndarray:
    """Distance of each point to the nearest one of another set, both ``(n, dimensions)``."""
    return cKDTree(among).query(points)[0]


def _shared_cells(points, among, cells: int) -> float:
    """Of the cells of the cube from -1 to 1 that `points` reach, the share that `among` reach."""
    mine, others, either = (
        cells_reached(x, 1.0, cells) for x in (points, among, np.concatenate([points, among]))
    )
    return (mine + others - either) / mine


def coverage(setup: Setup, tests: dict, members: int) -> dict:
    """Shared cells and distances of two families, both ways, beside a second draw of the same."""
    today, pair = setup.repeated(TEST_DAY), ("pick and place", "circles")
    again = (
        today.record(random_extents(members, TEST_DAY + 1)),
        recorded(today, stirred(setup.arm, random_circles(members, TEST_DAY + 1), times())),
    )
    first = {name: states(tests[name], setup) for name in pair}
    second = {name: states(run, setup) for name, run in zip(pair, again)}
    every = np.concatenate([*first.values(), *second.values()])
    low, high, deviation = every.min(0), every.max(0), every.std(0)
    named = first | {f"{name} again": x for name, x in second.items()}
    cube = {n: np.clip((2 * x - low - high) / (high - low), -1, 1) for n, x in named.items()}
    result: dict = {"tied": {}}
    for name, x in first.items():
        result["tied"][name] = [np.corrcoef(x[:, k], x[:, k + 2])[0, 1] for k in (0, 3)]
    for (part, axes), (name, other) in product(_AXES.items(), (pair, pair[::-1])):
        mine = (first[name] / deviation)[:, axes]
        result.setdefault(part, {})[name] = {
            kind: {
                "shared": _shared_cells(cube[name][:, axes], cube[label][:, axes], CELLS),
                "distance": np.median(_nearest_distances(mine, (x / deviation)[:, axes])),
            }
            for kind, label, x in (
                ("other family", other, first[other]),
                ("same family", f"{name} again", second[name]),
            )
        }
    return result


_TRAINED = 5  # motions of a family on a day: as many as Appendix I has for training


def on_several_days(setup: Setup, references: list[Trajectory], days) -> list[Recording]:
    """Recordings of references of each day, with its own zero of the encoders and noise."""
    days = np.asarray(days)
    together = Trajectory(*(np.stack(parts) for parts in zip(*references)))
    today = replace(setup, effects=on_days(setup.effects, setup, days))
    seeds = 1000 * (1 + days[:, None]) + np.arange(together.q.shape[1])
    log = recorded(today, together, seed=seeds)
    return [log[k] for k in range(len(days))]


def training(setup: Setup, days) -> list[dict[str, Recording]]:
    """Recordings of five motions of each family, for each day, which is the seed of their draw."""
    t = times()
    references = {
        "pick and place": lambda day: pick_and_place(APPENDIX_I[:_TRAINED], t),
        "circles": lambda day: stirred(setup.arm, random_circles(_TRAINED, day), t),
        "via points": lambda day: _via_points(_random_points(_TRAINED, _VIA, day), t),
    }
    each = [[make(day) for make in references.values()] for day in days]
    joined = [Trajectory(*(np.concatenate(parts) for parts in zip(*day))) for day in each]
    logs = on_several_days(setup, joined, days)
    return [
        {name: log[k * _TRAINED : (k + 1) * _TRAINED] for k, name in enumerate(references)}
        for log in logs
    ]
