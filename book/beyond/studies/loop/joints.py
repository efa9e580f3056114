"""Section 7.1, joints three and four: the window network on arms of one to seven joints.

Every training set has `TRAINING_CASES` windows, however many motions they come from.
"""

from __future__ import annotations

import warnings
from itertools import pairwise, product

import numpy as np

from beyond.rivals.identified import Linear
from beyond.rivals.protocol import Cases, derivative_filters
from beyond.studies.loop import chain as arms
from ddlib import paper
from ddlib.analysis import gains, mean_gradient
from ddlib.dynamics import (
    DD_ARM_II_IN_SPACE,
    count_operations,
    lagrange_euler,
    locked,
    mass_matrix,
    newton_euler,
    regressor,
)
from ddlib.identification import SIGN_SPEED
from ddlib.learning import NotConverged, Solution, TrainingSet, Weights, solve, surrogate
from ddlib.metrics import rmss
from ddlib.setups import INITIAL, JOINT_DAMPING, STATE_FEEDBACK
from ddlib.simulation import LOG_STEP
from workshop.report.code_hash import study
from workshop.report.exact_states import INITIAL as STATES_INITIAL

TRAINING_CASES = 750  # windows of a training set: what five motions have, every 20 ms
_STEPS, _DECAY = 60, 1e-6  # of Levenberg-Marquardt; `JOINT_DAMPING` has 120 and this decay

# Training motions by number of joints.
_MOTIONS_OF = {
    1: (2, 3, 5, 10, 20, 40, 80),
    2: (2, 3, 5, 7, 10, 20, 40, 80),
    3: (5, 7, 10, 14, 20, 40, 80),
    4: (5, 7, 10, 14, 20, 40, 80),
    5: (5, 10, 14, 20, 40, 80),
    7: (5, 10, 14, 20, 40, 80),
}

SEEDS = 10  # draws of motions, noise and weights
TEST_MOTIONS, TEST_SEED = 20, 1000
_UNITS = (5, 20, 40)  # besides the report's ten, at four joints
_STATE_SAMPLES, _STATE_STEPS, _STATE_TEST = (100, 300, 1000, 3000), 40, 2000  # of random states
_MAIN = 20  # training motions of the networks whose filters are read
_REST = arms.SPACING * LOG_STEP  # s, from one tap of a window to the next


def solved(windows, torque, test, hidden=paper.HIDDEN_UNITS, seed=0, **options) -> Solution:
    """One network trained on windows (or states) and torques; ``test`` holds both, too."""
    joints, width = windows.shape[1:]
    data = TrainingSet.from_arrays(windows, torque)
    initial = options.pop("initial", INITIAL)
    start = Weights.random(1, width, hidden, joints, joints, initial=initial, seed=seed)
    options = {"steps": _STEPS, "decay": _DECAY, **options}
    # the number of steps is the setting
    with warnings.catch_warnings(action="ignore", category=NotConverged):
        return solve(start, data, test=data.transform(*test), progress=False, **options)


def sets(made: arms.Chain, motions: int, seed: int, **options) -> arms.Sample:
    """A training set of `TRAINING_CASES` windows from so many motions of an arm."""
    drawn = arms.extents(made.joints, motions, seed)
    return arms.recorded(made, drawn, seed, **options).thinned(TRAINING_CASES)


def tested(made: arms.Chain, **options) -> arms.Sample:
    """The test motions, every fourth of their windows."""
    drawn = arms.extents(made.joints, TEST_MOTIONS, TEST_SEED)
    return arms.recorded(made, drawn, TEST_SEED, **options).thinned(TRAINING_CASES)


def linear(training: arms.Sample, test: arms.Sample) -> float:
    """Error of a linear filter of the windows, its ridge chosen by leaving parts out."""
    rival = Linear().fit(Cases(training.windows, training.torque, "windows", _REST))
    return float(rmss(rival._torque(test.windows), test.torque))


def _identified(made: arms.Chain, training: arms.Sample, test: arms.Sample) -> tuple[float, float]:
    """Errors (training, test) of the equations with friction, of the better of two degrees."""
    scale, candidates = training.torque.std(0), []
    for degree in (3, 4):
        first = _equations(made, training.windows, degree)
        matrix = (first / scale[:, None]).reshape(-1, first.shape[-1])
        size = np.sqrt((matrix**2).mean(0))
        size[size < 1e-9] = 1.0
        wanted = (training.torque / scale).ravel()
        values = np.linalg.lstsq(matrix / size, wanted, rcond=1e-6)[0] / size
        candidates.append((float(rmss(first @ values, training.torque)), degree, values))
    error, degree, values = min(candidates, key=lambda each: each[0])
    answer = _equations(made, test.windows, degree) @ values
    return error, float(rmss(answer, test.torque))


def _equations(made: arms.Chain, windows, degree: int) -> np.ndarray:
    """Regressor of rigid body and friction at states of polynomials through the windows."""
    states = windows @ derivative_filters(windows.shape[-1], _REST, degree).T
    speed, own = states[..., 1], np.eye(made.joints)
    rigid = regressor(made.arm, *np.moveaxis(states, -1, 0))
    sign = np.clip(speed / SIGN_SPEED, -1, 1)
    return np.concatenate([rigid, own * speed[..., None], own * sign[..., None]], -1)


def _trained(training, test, hidden=paper.HIDDEN_UNITS, **options) -> dict:
    """Last errors of networks, one for each training set; all are pairs of inputs and torques."""
    histories = [
        solved(*pair, test, hidden, seed, **options).history
        for seed, pair in enumerate(training, 1)
    ]
    return {side: [getattr(h, side)[-1, 0] for h in histories] for side in ("training", "test")}


# --- the parts of the study ---------------------------------------------------------------


def _by_motions(reading: str, ladder: dict, seeds: int) -> list[dict]:
    """Errors of networks and of a linear filter, by joints and their numbers of motions."""
    rows = []
    for joints, motions in ladder.items():
        arm = arms.chain(joints, reading)
        test = tested(arm)
        for count_of in motions:
            row = {"joints": joints, "motions": count_of}
            row |= {"training": [], "test": [], "by joint": [], "linear": []}
            for seed in range(1, 1 + seeds):
                training = sets(arm, count_of, seed)
                solution = solved(*training.pair, test.pair, seed=seed)
                answer = solution.model[0].torque(test.windows)
                row["training"].append(float(solution.history.training[-1, 0]))
                row["test"].append(float(solution.history.test[-1, 0]))
                row["by joint"].append(rmss(answer, test.torque, pooled=False))
                row["linear"].append(linear(training, test))
            rows.append(row)
    return rows


def _known_structure(joints=(1, 2, 3, 4, 5, 7), motions=(5, 20), seeds=SEEDS) -> list[dict]:
    """Errors of the identified equations, by joints and motions, one for each of the seeds."""
    rows = []
    for n in joints:
        arm = arms.chain(n)
        test = tested(arm)
        for m in motions:
            each = [_identified(arm, sets(arm, m, s), test) for s in range(1, 1 + seeds)]
            training, errors = zip(*each)
            rows.append({"joints": n, "motions": m, "training": training, "test": errors})
    return rows


def _closed_loops(seeds: int = SEEDS) -> list[dict]:
    """Two joints: recordings of closed loops beside motions followed exactly, both readings."""
    rows = []
    for setup, motions in product((JOINT_DAMPING, STATE_FEEDBACK), (5, _MAIN)):
        arm = arms.chain(2, setup.name)
        drawn = [arms.extents(2, motions, seed) for seed in range(1, 1 + seeds)]
        loop = setup.record(np.vstack([arms.extents(2, TEST_MOTIONS, TEST_SEED), *drawn]))
        plan = [(arms.SPACING, kind) for kind in ("closed loop", *arms.MOTIONS)]
        if motions == _MAIN:
            plan += [(1, "closed loop"), (1, arms.MOTIONS[0])]
        for spacing, kind in plan:
            if kind == "closed loop":
                test, *trained = _cut(loop, spacing, motions)
            else:
                options = {"motion": kind, "spacing": spacing}
                test = tested(arm, **options)
                trained = [sets(arm, motions, s, **options) for s in range(1, 1 + seeds)]
            rows.append(
                {
                    "reading": setup.name,
                    "motions": motions,
                    "taps": 2 * arms.REACH // spacing + 1,
                    "kind": kind,
                    "deviation": test.torque.std(0),
                    **_trained([sample.pair for sample in trained], test.pair),
                }
            )
    return rows


def _cut(loop, spacing: int, motions: int) -> list[arms.Sample]:
    """Test set and training sets of a recording of closed loops, cut as `recorded` does."""
    centres = np.arange(loop.motion.start, loop.motion.stop, arms.EVERY)
    taps = centres[:, None] + np.arange(-arms.REACH, arms.REACH + 1, spacing)
    windows, torque = np.moveaxis(loop.q[:, taps], -1, -2), loop.tau[:, centres]
    ends = [0, *range(TEST_MOTIONS, len(windows) + 1, motions)]
    samples = []
    for first, last in pairwise(ends):
        x, y = windows[first:last], torque[first:last]
        flat = x.reshape(-1, *x.shape[2:]), y.reshape(-1, 2)
        samples.append(
            arms.Sample(*flat, np.zeros((len(flat[1]), 0)), last - first).thinned(TRAINING_CASES)
        )
    return samples


def _units() -> list[dict]:
    """Four joints with other numbers of hidden units."""
    arm = arms.chain(4)
    test = tested(arm)
    rows = []
    for hidden in _UNITS:
        for motions in (5, _MAIN) if hidden < 40 else (_MAIN,):
            trained = [sets(arm, motions, seed).pair for seed in range(1, 1 + SEEDS)]
            row = {"units": hidden, "motions": motions}
            rows.append(row | _trained(trained, test.pair, hidden))
    return rows


def _random_cube(joints: int, samples: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Random states of section 6 for more joints, and the rigid body's torque, N m."""
    rng = np.random.default_rng((seed, joints))
    states = rng.uniform(-np.pi, np.pi, (samples, joints, 3))
    return states, arms.chain(joints).arm.inverse_dynamics(*np.moveaxis(states, -1, 0))


def _random_states() -> list[dict]:
    """Errors on random states by joints, samples and hidden units."""
    rows, options = [], {"steps": _STATE_STEPS, "decay": 0.0, "initial": STATES_INITIAL}
    for joints in _MOTIONS_OF:
        test = _random_cube(joints, _STATE_TEST, TEST_SEED)
        plan = [(10, n) for n in (_STATE_SAMPLES if joints < 5 else _STATE_SAMPLES[2:3])]
        plan += [(20, n) for n in _STATE_SAMPLES[2:] if joints in (3, 4)]
        for hidden, samples in plan:
            trained = [_random_cube(joints, samples, seed) for seed in range(1, 1 + SEEDS)]
            row = {"joints": joints, "units": hidden, "samples": samples}
            rows.append(row | _trained(trained, test, hidden, **options))
    return rows


def _pairs(joints: int = 4, seeds: int = SEEDS) -> dict:
    """Which joints' windows each torque uses: gains on acceleration beside the arm's inertia."""
    arm = arms.chain(joints)
    test = tested(arm)
    inertia = mass_matrix(arm.arm, test.states[..., 0]).mean(0)
    by_kind: dict = {"real": [], "unrelated": []}
    used: dict = {"real": [], "unrelated": []}
    for seed in range(1, 1 + seeds):
        whole = arms.recorded(arm, arms.extents(joints, _MAIN, seed), seed)
        runs = whole.torque.reshape(_MAIN, -1, joints)
        torques = {"real": runs, "unrelated": surrogate("phases", runs, seed)}
        step = -(-len(whole.torque) // TRAINING_CASES)
        for kind, torque in torques.items():
            x, y = whole.windows[::step], torque.reshape(-1, joints)[::step]
            model = solved(x, y, test.pair, seed=seed).model[0]
            by_kind[kind].append(gains(mean_gradient(model, test.windows), _REST)[..., 2])
            used[kind].append(_shuffled(model.torque, test.windows, y.std(0), seed))

    return {
        "joints": joints,
        "inertia": inertia,
        "gains": by_kind,
        "used": used,
        "exact": _shuffled(arm.torque, test.states, test.torque.std(0), 1),
        "deviation": test.torque.std(0),
        "acceleration": test.states[..., 2].std(0),
    }


def _shuffled(predict, x, scale, seed: int) -> np.ndarray:
    """RMS change of each torque when one joint's window is that of another case, over `scale`."""
    order = np.random.default_rng(seed).permutation(len(x))
    before, changes = predict(x), []
    for j in range(x.shape[1]):
        other = x.copy()
        other[:, j] = x[order, j]
        changes.append(np.sqrt(((predict(other) - before) ** 2).mean(0)) / scale)
    return np.stack(changes, -1)  # (torque, window)


def _interactions() -> dict:
    """How much of each torque is owed to the other joints: RMS without them, over the deviation."""
    shares = {}
    for joints in (2, 3, 4, 5, 7):
        arm = arms.chain(joints)
        states = tested(arm).states
        whole, alone = arm.torque(states), np.zeros(states.shape[:2])
        for j in range(joints):
            only = np.zeros_like(states)
            only[:, j] = states[:, j]
            alone[:, j] = arm.torque(only)[:, j]
        coupling = whole - alone
        shares[str(joints)] = (coupling - coupling.mean(0)).std(0) / whole.std(0)
    return shares


def _costs(width: int = 21, hidden: int = paper.HIDDEN_UNITS) -> list[dict]:
    """Multiplications of the network, and of two formulations counted by running them."""
    rows = []
    for n in range(2, DD_ARM_II_IN_SPACE.joints + 1):
        arm = locked(DD_ARM_II_IN_SPACE, n)
        rows.append(
            {
                "joints": n,
                "network": hidden * n * width + hidden * n + n * n * width,
                "Newton-Euler, general": count_operations(newton_euler, arm).multiplications,
                "Newton-Euler, this arm": count_operations(
                    newton_euler, arm, "arm"
                ).multiplications,
                "Lagrange-Euler, general": count_operations(lagrange_euler, arm).multiplications,
            }
        )
    return rows


@study
def _joints() -> dict:
    """All of it; what each part holds stands with its function."""
    second = {n: (5, _MAIN, 40) for n in (1, 2, 3, 4)}
    return {
        "cases": TRAINING_CASES,
        "steps": _STEPS,
        "seeds": SEEDS,
        "test motions": TEST_MOTIONS,
        "windows": _by_motions(JOINT_DAMPING.name, _MOTIONS_OF, SEEDS),
        "windows, state feedback": _by_motions(STATE_FEEDBACK.name, second, SEEDS),
        "known structure": _known_structure(),
        "closed loops": _closed_loops(),
        "units": _units(),
        "random states": _random_states(),
        "pairs": _pairs(),
        "interactions": _interactions(),
        "costs": _costs(),
    }
