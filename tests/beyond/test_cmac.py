"""CMAC against a plain loop, against a dense linear model, and where collisions bite."""

import numpy as np
import pytest

from beyond.rivals.cmac import CMAC, Diverged
from beyond.rivals.protocol import Cases

BOX = np.stack([np.full((2, 3), -1.0), np.full((2, 3), 1.0)])


def data(n=120, seed=0):
    x = np.random.default_rng(seed).uniform(-1, 1, (n, 2, 3))
    torque = np.stack([x[:, 0].sum(1), np.sin(2 * x[:, 1, 0]) * x[:, 0, 1]], -1)
    return Cases(x, torque, "states", 0.01)


def cubes(rival, x):
    """Albus's addresses written down plainly: the layer and six whole numbers."""
    u = (x.reshape(len(x), -1) - rival.low.ravel()) / (rival.high - rival.low).ravel()
    steps = np.floor(u / rival.width * rival.layers).astype(int)  # quantised once
    return [[(c, *((row + c) // rival.layers)) for c in range(rival.layers)] for row in steps]


def slot_of(rival):
    """The slot of a cube, by SplitMix64 in Python's own whole numbers."""
    edge = int(np.ceil(1 / rival.width)) + 1

    def slot(cube):
        number = cube[0]
        for k in cube[1:]:
            number = number * edge + int(k)
        mixed = (number + 0x9E3779B97F4A7C15) % 2**64
        mixed = (mixed ^ mixed >> 30) * 0xBF58476D1CE4E5B9 % 2**64
        mixed = (mixed ^ mixed >> 27) * 0x94D049BB133111EB % 2**64
        return (mixed ^ mixed >> 31) % rival.slots

    return slot


def by_loop(rival, cases, epochs, place):
    """The delta rule as it is written: case after case, weight after weight."""
    weights, rows = {}, [[place(cube) for cube in row] for row in cubes(rival, cases.x)]
    for _ in range(epochs):
        for row, torque in zip(rows, cases.torque):
            error = torque - sum(weights.get(s, 0.0) for s in row)
            for s in row:
                weights[s] = weights.get(s, 0.0) + rival.rate * error / rival.layers
    return np.array([sum(weights.get(s, 0.0) for s in row) for row in rows])


def test_blocks_of_updates_are_the_loop():
    cases = data(700)  # more than two blocks
    options = {"layers": 8, "width": 0.4, "epochs": 3, "rate": 0.7, "limits": BOX}
    free = CMAC(**options).fit(cases)
    looped = by_loop(free, cases, 3, lambda cube: cube)
    np.testing.assert_allclose(free.torque(cases.x), looped, rtol=1e-9, atol=1e-9)
    assert free.count() == 3 * free.visited + 12  # weights and an address each, and the box
    hashing = CMAC(**options, slots=50).fit(cases)
    assert hashing.count() == 2 * 50 + 12
    looped = by_loop(hashing, cases, 3, slot_of(hashing))
    np.testing.assert_allclose(hashing.torque(cases.x), looped, rtol=1e-9, atol=1e-9)


def test_own_collisions_make_it_diverge_and_the_history_is_kept():
    cases = data(200)
    rival = CMAC(layers=32, slots=8, epochs=200, limits=BOX)
    with pytest.raises(Diverged, match=r"rate x overlap is .* must be below 2: take more slots"):
        rival.fit(cases)
    assert rival.rate * rival.overlap > 2
    assert len(rival.history) >= 2 and rival.history[-1] > 1000 * rival.history[0]
    slower = CMAC(layers=32, slots=8, epochs=200, rate=1.9 / rival.overlap, limits=BOX).fit(cases)
    assert max(slower.history) < 10 * slower.history[0]
