"""CMAC against a plain loop, against a dense linear model, and where collisions bite."""

import numpy as np
import pytest

from workshop.beyond.rivals.cmac import CMAC, Diverged, hashed
from workshop.beyond.rivals.protocol import Cases

RNG = np.random.default_rng(2)
BOX = np.stack([np.full((2, 3), -1.0), np.full((2, 3), 1.0)])


def data(n=120, seed=0):
    x = np.random.default_rng(seed).uniform(-1, 1, (n, 2, 3))
    torque = np.stack([x[:, 0].sum(1), np.sin(2 * x[:, 1, 0]) * x[:, 0, 1]], -1)
    return Cases(x, torque, "states", 0.01)


def cube_names(rival, x):
    """Albus's addresses written down plainly: the layer and six whole numbers."""
    u = (x.reshape(len(x), -1) - rival.low.ravel()) / (rival.high - rival.low).ravel()
    steps = np.floor(u / rival.width * rival.layers).astype(int)  # quantised once
    return [[(c, *((row + c) // rival.layers)) for c in range(rival.layers)] for row in steps]


def by_loop(rival, cases, epochs, slot_of):
    """The delta rule as it is written: case after case, weight after weight."""
    weights = {}
    for _ in range(epochs):
        for names, torque in zip(cube_names(rival, cases.x), cases.torque):
            slots = [slot_of(name) for name in names]
            error = torque - sum(weights.get(s, 0.0) for s in slots)
            for s in slots:
                weights[s] = weights.get(s, 0.0) + rival.rate * error / rival.layers
    return np.array(
        [sum(weights.get(slot_of(n), 0.0) for n in names) for names in cube_names(rival, cases.x)]
    )


def numbered(rival):
    """The number of a cube, as `CMAC` counts them; and its slot."""
    edge = int(np.ceil(1 / rival.width)) + 1

    def number(name):
        found = name[0]
        for k in name[1:]:
            found = found * edge + int(k)
        return found

    return number


def test_blocks_of_updates_are_the_loop():
    cases = data(700)  # more than two blocks
    rival = CMAC(layers=8, width=0.4, epochs=3, rate=0.7, limits=BOX).fit(cases)
    looped = by_loop(rival, cases, 3, lambda name: name)
    np.testing.assert_allclose(rival.torque(cases.x), looped, rtol=1e-9, atol=1e-9)
    hashing = CMAC(layers=8, width=0.4, slots=50, epochs=3, rate=0.7, limits=BOX).fit(cases)
    number = numbered(hashing)
    looped = by_loop(hashing, cases, 3, lambda name: int(hashed([number(name)], 50)[0]))
    np.testing.assert_allclose(hashing.torque(cases.x), looped, rtol=1e-9, atol=1e-9)


def test_without_collisions_it_ends_as_the_dense_linear_model():
    """From zero weights the delta rule ends at the shortest solution, if there is one."""
    cases = data(60)
    rival = CMAC(layers=6, width=0.5, epochs=3000, limits=BOX).fit(cases)
    names = cube_names(rival, cases.x)
    known = sorted({name for row in names for name in row})
    dense = np.array([[float(name in row) for name in known] for row in names])
    assert dense.shape == (60, rival.visited) and rival.overlap == 1.0 and rival.sharing == 0.0
    assert np.linalg.matrix_rank(dense) == 60  # so that every torque can be met
    shortest = np.linalg.lstsq(dense, cases.torque, rcond=None)[0]
    np.testing.assert_allclose(rival.torque(cases.x), cases.torque, atol=1e-6)
    asked = data(40, seed=9).x * 0.9
    rows = np.array([[float(n in row) for n in known] for row in cube_names(rival, asked)])
    np.testing.assert_allclose(rival.torque(asked), rows @ shortest, atol=1e-5)


def test_as_many_slots_as_never_collide_change_nothing():
    cases = data(80)
    free = CMAC(layers=4, epochs=20, limits=BOX).fit(cases)
    many = CMAC(layers=4, epochs=20, slots=10**7, limits=BOX).fit(cases)
    assert many.occupied == many.visited == free.visited
    np.testing.assert_allclose(many.torque(cases.x), free.torque(cases.x), atol=1e-9)


def test_collisions_are_counted():
    cases = data(80)
    rival = CMAC(layers=4, slots=20, epochs=1, limits=BOX).fit(cases)
    number = numbered(rival)
    cubes = {number(n) for row in cube_names(rival, cases.x) for n in row}
    slots = [int(hashed([c], 20)[0]) for c in cubes]
    assert rival.visited == len(cubes) and rival.occupied == len(set(slots))
    assert rival.sharing == pytest.approx(np.mean([slots.count(s) > 1 for s in slots]))
    counts = [
        sum(v**2 for v in np.unique([hashed([number(n)], 20)[0] for n in row],
                                    return_counts=True)[1])
        for row in cube_names(rival, cases.x)
    ]  # fmt: skip
    assert rival.overlap == pytest.approx(max(counts) / 4)


def test_hashing_scatters_evenly_and_always_alike():
    found = hashed(np.arange(100_000), 64)
    counts = np.bincount(found, minlength=64)
    assert ((counts - 100_000 / 64) ** 2 / (100_000 / 64)).sum() < 120  # chi squared, 63 free
    np.testing.assert_array_equal(hashed(np.arange(5), 64), found[:5])
    assert found.min() >= 0 and found.max() == 63


def test_own_collisions_make_it_diverge_and_the_history_is_kept():
    cases = data(200)
    rival = CMAC(layers=32, slots=8, epochs=200, limits=BOX)
    with pytest.raises(Diverged, match=r"rate x overlap is .* must be below 2: take more slots"):
        rival.fit(cases)
    assert rival.rate * rival.overlap > 2
    assert len(rival.history) >= 2 and rival.history[-1] > 1000 * rival.history[0]
    slower = CMAC(layers=32, slots=8, epochs=200, rate=1.9 / rival.overlap, limits=BOX).fit(cases)
    assert max(slower.history) < 10 * slower.history[0]


def test_collisions_of_different_cases_do_not():
    """Nearly all cubes share a slot, hardly any with one of the same case: it stays bounded."""
    cases = data(400)
    rival = CMAC(layers=16, slots=100, epochs=300, limits=BOX).fit(cases)
    assert rival.sharing > 0.99 and rival.rate * rival.overlap < 2
    assert max(rival.history) <= 1.5 * rival.history[0]


def test_a_wider_cube_generalises_further():
    """One case alone: how far from it the torque is felt."""
    x = np.zeros((1, 2, 3))
    cases = Cases(x, np.array([[1.0, 1.0]]), "states", 0.01)
    away = np.zeros((41, 2, 3))
    away[:, 0, 0] = np.linspace(0, 1, 41)
    for width in (0.1, 0.25, 0.5):
        felt = CMAC(layers=16, width=width, epochs=1, limits=BOX).fit(cases)._torque(away)[:, 0]
        assert felt[0] == pytest.approx(1.0) and (np.diff(felt) <= 1e-12).all()
        reach = away[felt > 1e-9, 0, 0].max() / 2  # the box has an edge of 2
        assert width * 0.9 - 0.02 <= reach <= width + 0.02


def test_what_makes_no_sense_is_refused():
    for wrong in ({"layers": 0}, {"width": 0.0}, {"rate": 2.5}, {"slots": 0}, {"epochs": 0}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            CMAC(**wrong)
    with pytest.raises(ValueError, match=r"width must leave fewer than 2\^62 cubes"):
        CMAC(width=0.001).fit(data(20))
    with pytest.raises(ValueError, match=r"position of joint 0 from -1 to 1 rad, got 1\.5"):
        CMAC(limits=BOX, epochs=1).fit(data(20)).torque(data(1).x * 0 + 1.5)


def test_numbers_and_operations():
    cases = data(50)
    free = CMAC(layers=4, epochs=1, limits=BOX).fit(cases)
    assert free.count() == 3 * free.visited + 12
    assert CMAC(layers=4, slots=30, epochs=1, limits=BOX).fit(cases).count() == 60 + 12
    assert free.operations()[:2] == (6, 24 + 6)
