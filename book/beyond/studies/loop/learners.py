"""What practises in the loop; rates, penalties, the memory's settings are of draws from 1000 on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from beyond.control.adaptive import Watched
from beyond.control.feedback_error import (
    FeedbackErrorLearning,
    GenericTerms,
    MotionMemory,
    RigidBodyTerms,
)
from beyond.control.online import (
    LastLayer,
    OnlineFeedforward,
    _LinearFilter,
    _OnlineDescent,
)
from ddlib.control import Feedforward
from ddlib.dynamics import follow_hand
from ddlib.effects import EncoderZero
from ddlib.identification import RecursiveLeastSquares
from ddlib.learning import TorqueModel, Weights
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK, Setup
from ddlib.simulation import CONTROL_STEP
from ddlib.trajectories import MOTION_SECONDS, Trajectory, smooth_pick_and_place, time_grid
from workshop.report import results

_SEEDS = 10
_TRIALS = 10  # of one motion, or with one load
_WIDTH = 21

# Range of the weights of hidden units that most learners never train: from the book's range of
# initial weights they would hardly bend
_FEATURES = 0.3
NAMES = ("a", "b", "d", "F_v1", "F_v2", "F_c1", "F_c2")  # of the exact terms: arm and friction
_RATE = 1.0  # of terms: 1/(s N m), over each term's mean square and their number
_PENALTY, FORGETTING = 1e-3, 0.999  # of recursive least squares: half after 7 s
TRUST = 1.0  # penalty where the network was trained off-line
REPLAY = 15  # earlier samples that are learnt again with each new one
_ONE_PASS, _REPLAYED, _TRAINED = 0.03, 1.0, 0.1  # rates of descent from measured windows

# Rate of descent by the feedback's torque: the largest tried whose error did not rise again.
_BY_FEEDBACK = {JOINT_DAMPING.name: 0.003, STATE_FEEDBACK.name: 0.03}

# Rate, lead and smoothing of the memory, the last two in control samples.
MEMORY = {JOINT_DAMPING.name: (0.1, 75, 10.0), STATE_FEEDBACK.name: (0.3, 25, 5.0)}


class Draw:
    """Draws of a set-up: motions, encoder zeros and networks; their axis is that of the seeds."""

    def __init__(self, setup: Setup, first: int = 0, seeds: int = _SEEDS):
        self.setup, self.seeds = setup, seeds
        rngs = [np.random.default_rng((77, first + k)) for k in range(seeds)]

        def drawn(low, high, *shape):
            return np.stack([rng.uniform(low, high, shape) for rng in rngs])

        self.learnt, self.other = drawn(20, 45, 2), drawn(10, 45, 2)
        self.second = drawn(4, 10, 2) * np.sign(drawn(-1, 1, 2))
        self.family = drawn(5, 45, 2 * _TRIALS, 2)
        zero = drawn(0.0, setup.effects.encoder[0].step, 2)
        encoder = (EncoderZero(zero), *setup.effects.encoder, EncoderZero(-zero))
        self.effects = replace(setup.effects, encoder=encoder)
        self.plain = Feedforward(lambda q, qd, qdd: 0 * q, setup.controller)
        self.limit = setup.effects.actuator[0].limit
        trained = results.networks(_WIDTH, setup.name)
        members = (first + np.arange(seeds)) % len(trained.weights)
        self.trained = replace(trained, weights=trained.weights[members][None])
        self.untrained = _untrained(self.trained, first)

    def equations(self, q, qd, qdd) -> np.ndarray:
        """The exact torque of a motion, friction included, N m."""
        friction = sum(f.torque(qd) for f in self.effects.friction)
        return self.setup.arm.inverse_dynamics(q, qd, qdd) + friction


def _untrained(like: TorqueModel, first: int) -> TorqueModel:
    """Networks that give no torque yet: only the weights of hidden units are drawn."""
    _, seeds, hidden = like.weights.hidden_bias.shape
    w = Weights.random(seeds, _WIDTH, hidden, initial=_FEATURES, seed=first)
    nothing = like.outputs.scale(np.zeros(2))
    bias = np.log(nothing / (1 - nothing)) + np.zeros((seeds, 2))
    none = {n: np.zeros_like(getattr(w, n)) for n in ("output_weights", "direct_weights")}
    return replace(like, weights=replace(w, output_bias=bias, **none)[None])


def grid(duration: float = MOTION_SECONDS) -> np.ndarray:
    """Control times of a motion with a tenth of it as rest before and after, s."""
    return time_grid(CONTROL_STEP, duration / 10, duration)


def motions(draw: Draw) -> dict[str, tuple[np.ndarray, Trajectory]]:
    """Times and references ``(seeds, time, 2)`` from rest to rest without a jump, by name."""
    found = {}
    for name, speed in (("the same", 1.0), ("in 2/3 of the time", 1.5), ("in half the time", 2.0)):
        t = grid(MOTION_SECONDS / speed)
        found[name] = t, smooth_pick_and_place(draw.learnt, t, speed)
    t = grid()
    found["other extents"] = t, smooth_pick_and_place(draw.other, t)
    slow = smooth_pick_and_place(0.6 * draw.learnt, t)
    third = 3 * t * ((t >= 0) & (t < MOTION_SECONDS))  # three turns in the time of one
    fast = smooth_pick_and_place(draw.second, third % MOTION_SECONDS)
    both = zip(slow, fast, (1, 3, 9))
    moving = ((t >= 0) & (t < MOTION_SECONDS))[:, None]
    found["two harmonics"] = t, Trajectory(*(a + moving * n * b for a, b, n in both))
    found["circle"] = t, _round(draw, t)
    return found


def _round(draw: Draw, t) -> Trajectory:
    """The hand goes once round a circle of 80 mm radius, from rest to rest; its place is drawn."""
    arm, turn, radius = draw.setup.arm, 2 * np.pi / MOTION_SECONDS, 0.08
    centre = arm.forward_kinematics(-np.deg2rad([5.0, 55.0] + draw.other / 3))[:, None, 1]
    phase = turn * np.clip(t, 0, MOTION_SECONDS)[:, None]
    angle, rate, gain = phase - np.sin(phase), turn * (1 - np.cos(phase)), turn**2 * np.sin(phase)
    along = radius * np.concatenate([np.cos(angle), np.sin(angle)], -1)
    across = radius * np.concatenate([-np.sin(angle), np.cos(angle)], -1)
    path = (centre + along, rate * across, gain * across - rate**2 * along)
    return follow_hand(arm, *(x + 0 * centre for x in path), elbow="negative")


class Terms:
    """Feedback-error learning of given terms, whose weights outlive a run."""

    def __init__(self, terms, draw: Draw, rate=_RATE):
        t = grid()
        extents = np.stack(np.meshgrid([10, 25, 40], [10, 25, 40]), -1).reshape(-1, 2)
        size = (terms(*smooth_pick_and_place(extents, t)) ** 2).sum(-2).mean((0, 1))
        self.terms, self.feedback = terms, draw.setup.controller
        self.rate = np.asarray(rate, float)[..., None] / (size * len(size))
        self.weights = np.zeros((1, draw.seeds, len(size)))

    def controller(self, learning=True):
        """A controller for one run, learning or as it is now."""
        rate = self.rate if learning else 0 * self.rate
        return Watched(FeedbackErrorLearning(self.terms, rate, self.weights, self.feedback))

    def keep(self, watched):
        """Go on from what the controller of a run has learnt."""
        self.weights = watched.law.weights[..., -1, :]


class _Windows:
    """A learner of windows."""

    def __init__(self, learner, teacher: str, draw: Draw):
        self.learner, self.teacher = learner, teacher
        self.feedback, self.limit = draw.setup.controller, draw.limit

    def controller(self, learning=True):
        teacher = self.teacher if learning else "nobody"
        return OnlineFeedforward(self.learner, self.feedback, _WIDTH, teacher, limit=self.limit)

    def keep(self, controller):
        """Nothing to do: the learner has learnt during the run."""


class _Memory:
    """The memory of a motion; it learns after each trial."""

    def __init__(self, draw: Draw):
        self.memory = MotionMemory(draw.setup.controller, *MEMORY[draw.setup.name])

    def controller(self, learning=True):
        return Watched(self.memory)

    def keep(self, watched):
        self.memory.learn(watched.law)


def _recursion(penalty):
    return lambda weights: RecursiveLeastSquares(weights, penalty, FORGETTING)


def _last_layer(model: TorqueModel, draw: Draw, penalty: float = _PENALTY) -> _Windows:
    """The network whose last layer learns by recursive least squares from measured windows."""
    return _Windows(LastLayer(model, _recursion(penalty)), "torque", draw)


def _linear_filter(draw: Draw) -> _Windows:
    """A linear filter of the window that learns in the same way, from nothing."""
    zero = np.zeros((1, draw.seeds, 2, 2 * _WIDTH + 1))
    return _Windows(_LinearFilter(draw.trained.inputs, zero, _recursion(_PENALTY)), "torque", draw)


def _by_feedback(model: TorqueModel, draw: Draw, times=1.0) -> _Windows:
    """The network that learns from desired windows and the feedback's torque."""
    rate = _BY_FEEDBACK[draw.setup.name] * np.asarray(times)
    return _Windows(_OnlineDescent(model, rate), "feedback", draw)


def _lineup(draw: Draw) -> dict[str, object]:
    """The learners that practise one motion, all from nothing."""
    return {
        "exact terms": Terms(RigidBodyTerms(NAMES), draw),
        "generic terms": Terms(GenericTerms(), draw),
        "network, by feedback": _by_feedback(draw.untrained, draw),
        "network, last layer": _last_layer(draw.untrained, draw),
        "linear filter": _linear_filter(draw),
        "memory": _Memory(draw),
    }


def _candidates(draw: Draw) -> dict[str, object]:
    """The learners of the family: from nothing, and from networks trained off-line."""
    return {
        "one pass": _Windows(_OnlineDescent(draw.untrained, _ONE_PASS), "torque", draw),
        "replay": _Windows(
            _OnlineDescent(draw.untrained, _REPLAYED, replay=REPLAY), "torque", draw
        ),
        "last layer": _last_layer(draw.untrained, draw),
        "by feedback": _by_feedback(draw.untrained, draw),
        "linear filter": _linear_filter(draw),
        "off-line, as it is": _Windows(_OnlineDescent(draw.trained, 0.0), "nobody", draw),
        "off-line, replay": _Windows(
            _OnlineDescent(draw.trained, _TRAINED, replay=REPLAY), "torque", draw
        ),
        "off-line, last layer": _last_layer(draw.trained, draw, TRUST),
        "off-line, by feedback": _by_feedback(draw.trained, draw),
    }
