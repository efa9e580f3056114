"""Figures of the dynamics chapter: sound, accessible, and showing what they were given."""

import re
import warnings

import numpy as np
import pytest
from pictures import check_sound, curves, drawn, figures_in, words

from ddlib.dynamics import CMU_DD_ARM_II, Operations
from ddlib.figures import COLOURS
from ddlib.identification import Equations, least_squares
from ddlib.trajectories import APPENDIX_I, pick_and_place
from workshop.chapters import dynamics as figures_dynamics

NAMES = ("x", "y")
COUNTS = {
    "steep": {n: Operations(10**n, 3) for n in (2, 3, 4)},
    "level": {n: Operations(500, 3) for n in (2, 3, 4)},
}
PUBLISHED = {"book": (4, 9000), "paper": (3, 600)}


def fitted(repetitions=None, offset=0.0):
    """Estimates of two parameters of which the truth is 1 and 2."""
    rng = np.random.default_rng(0)
    a = rng.normal(size=(50, 2))
    shape = (50,) if repetitions is None else (repetitions, 50)
    y = a @ [1.0 + offset, 2.0 + offset] + 0.1 * rng.normal(size=shape)
    a = np.broadcast_to(a, (*shape, 2))
    return least_squares(Equations(NAMES, (a,), (y,)))


EXAMPLES = {
    "hand_paths": lambda: figures_dynamics.hand_paths(CMU_DD_ARM_II, APPENDIX_I),
    "operations": lambda: figures_dynamics.operations(COUNTS, PUBLISHED, (200, 1000)),
    "estimates": lambda: figures_dynamics.estimates(
        {"fair": fitted(100), "off": fitted(100, 0.5), "once": fitted()}, [1.0, 2.0], NAMES, 20.0
    ),
}


@pytest.fixture(scope="module")
def made():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return {name: drawn(make) for name, make in EXAMPLES.items()}


def test_every_figure_has_an_example():
    assert figures_in(figures_dynamics) - {"arm_sketch"} == set(
        EXAMPLES
    )  # its test is in test_weights.py


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_and_accessible(made, name):
    figure, _ = made[name]
    check_sound(figure)
    assert "nan" not in figure.alt
    assert len(figure.svg) < 150_000
    fixed = set(re.findall(r"(?:fill|stroke): (#000000|#ffffff|black|white)", figure.svg))
    assert not fixed or (name, fixed) == ("hand_paths", {"#ffffff"}), "the joints are white"


def test_alt_texts_say_the_numbers(made):
    l1, l2 = CMU_DD_ARM_II.lengths
    bend = np.deg2rad(45.0)  # the largest elbow angle is the shortest reach
    near = np.sqrt(l1**2 + l2**2 + 2 * l1 * l2 * np.cos(bend))
    assert f"from {near:.2f} to {l1 + l2:.2f} m" in made["hand_paths"][0].alt
    assert "steep: 10,000; level: 500" in made["operations"][0].alt
    assert "off: x 50, y 25" in made["estimates"][0].alt and "fair: x" in made["estimates"][0].alt


def test_counts_are_drawn_on_a_logarithmic_scale(made):
    figure = made["operations"][1]
    assert figure.axes[0].get_yscale() == "log"
    for colour, by_joints in zip(COLOURS, COUNTS.values()):
        (line,) = curves(figure, colour)
        assert [tuple(point) for point in line] == [
            (joints, operations.multiplications) for joints, operations in by_joints.items()
        ]


def test_counts_have_a_form_for_a_narrow_page(made):
    assert all(name in made["operations"][0].narrow for name in COUNTS)


def test_hand_paths_begin_in_one_point_and_end_where_the_arm_does(made):
    figure = made["hand_paths"][1]
    paths = [max(curves(figure, colour), key=len) for colour in COLOURS]
    starts, turns = np.array([(path[0], path[-1]) for path in paths]).swapaxes(0, 1)
    l1, l2 = CMU_DD_ARM_II.lengths
    np.testing.assert_allclose(starts, np.tile([l1 + l2, 0.0], (len(COLOURS), 1)), atol=1e-9)
    t = np.deg2rad(-APPENDIX_I)
    x = l1 * np.cos(t[:, 0]) + l2 * np.cos(t.sum(1))
    y = l1 * np.sin(t[:, 0]) + l2 * np.sin(t.sum(1))
    np.testing.assert_allclose(turns, np.stack([x, y], -1), atol=1e-9)
    assert figure.axes[0].get_aspect() == 1.0


def test_shares_stand_beside_repeated_estimates_only(made):
    found = [re.fullmatch(r"(\d+) %", text) for text in words(made["estimates"][0])]
    shares = [share[1] for share in found if share]
    assert len(shares) == 4, "two rows with repetitions, two panels"
    fair = fitted(100).covers([1.0, 2.0]).mean(0)
    assert shares[:2] == [f"{100 * fair[0]:.0f}", "0"] and shares[2] == f"{100 * fair[1]:.0f}"


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: figures_dynamics.hand_paths(CMU_DD_ARM_II, [np.nan, 0.0]), "extents_deg must"),
        (lambda: figures_dynamics.estimates({"a": fitted()}, [1.0, 2.0], NAMES, 0.0), "limit"),
        (lambda: figures_dynamics.estimates({"a": fitted()}, [1.0], NAMES, 5.0), "truth must"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_labels_keep_away_from_what_is_drawn():
    """The number of a trajectory lies on no arm and no path, and near its own end point."""
    points = CMU_DD_ARM_II.forward_kinematics(pick_and_place(APPENDIX_I, np.linspace(0, 1.5, 60)).q)
    turned = np.concatenate([np.zeros((6, 1, 2)), points[:, -1]], 1)
    along = np.linspace(0, 1, 40)[:, None, None, None]
    arms = turned[:, :-1] + along * np.diff(turned, axis=1)
    drawn = np.concatenate([points[:, :, 1].reshape(-1, 2), arms.reshape(-1, 2)])
    for end in points[:, -1, 1]:
        place = figures_dynamics._free_place(end, drawn)
        assert np.isclose(np.linalg.norm(place - end), 0.035)
        assert np.linalg.norm(drawn - place, axis=-1).min() > 0.015
