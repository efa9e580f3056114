"""The experiment of section 4, as this book repeats it: one place for every choice made."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np

from ddlib import paper
from ddlib._check import finite_array, instance, integer, number, pair, seed_number, text
from ddlib.control import Controller, as_controller, pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II, Arm
from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    CoulombFriction,
    Effects,
    EncoderZero,
    Quantisation,
    ViscousFriction,
)
from ddlib.learning import INITIAL, TorqueModel, TrainingSet, Weights, cases, sliding_windows
from ddlib.metrics import rmss
from ddlib.simulation import Recording, record
from ddlib.trajectories import APPENDIX_I

if TYPE_CHECKING:  # these need torch, which a page without training does without
    from ddlib.learning import History

KP = (300.0, 90.0)
"""Gains on the position error of shoulder and elbow, N m/rad. Assumed: stiff enough to follow
the family within a few degrees. Softer and stiffer ones are compared in the book."""

KD = (35.0, 10.0)
"""Gains on the velocity error, N m s/rad. Assumed: damping ratios of about 0.4 and 0.6."""

WINDOWS = tuple(paper.TABLE_4_1)
"""Window sizes of Table 4-1."""

MOMENTUM = 0.98
"""Acceleration factor. Assumed; Lang (1988) used 0.95, which leaves the training error far
from its asymptote after the paper's 20,000 epochs."""

WARM_UP = 1000
"""Epochs at the start with a momentum of 0.5. Assumed; Lang (1988) raised it from .5 to .95.
Without them a few networks in a hundred saturate early and never recover."""

COURSE = (*sorted({0, *(round(10 ** (k / 14)) for k in range(61))}), paper.EPOCHS)
"""Epochs after which the weights of the first networks are kept: 14 in each decade."""


@dataclass(frozen=True)
class Setup:
    """Arm, effects, controller and training: everything that decides Table 4-1."""

    name: str  #: What tables call it.
    controller: Controller
    arm: Arm = CMU_DD_ARM_II
    effects: Effects = CMU_DD_ARM_II_EFFECTS
    epochs: int = paper.EPOCHS
    momentum: float = MOMENTUM
    warm_up: int = WARM_UP
    initial: float = INITIAL
    rate: float = 33.0  #: Step size per case times the width of the window.
    scaling: tuple[float, float] = (0.0, 1.0)  #: Range that the network's inputs are scaled to.
    hidden: int = paper.HIDDEN_UNITS  #: Number of hidden units.
    seed: int = 0  #: Of the sensor noise of the recording.
    steps: int = 0  #: Of Levenberg-Marquardt in place of descent, converged or not; 0: descent.
    decay: float = 0.0  #: Weight decay of Levenberg-Marquardt.

    def __post_init__(self):
        text("name", self.name)
        as_controller(self.controller)
        instance("arm", self.arm, Arm)
        instance("effects", self.effects, Effects)
        integer("epochs", self.epochs, 1)
        number("momentum", self.momentum, 0.0, 0.999)
        integer("warm_up", self.warm_up, 0)
        number("initial", self.initial, 0.0, open_low=True)
        number("rate", self.rate, 0.0, open_low=True)
        pair("scaling", self.scaling)
        integer("hidden", self.hidden, 1)
        seed_number("seed", self.seed)
        integer("steps", self.steps, 0)
        number("decay", self.decay, 0.0)
        if self.decay and not self.steps:
            raise ValueError(f"decay must be 0 for descent (steps = 0), got {self.decay:g}")

    def record(self, extents_deg=APPENDIX_I, **options) -> Recording:
        """The recording of all runs, noise included; `options` as in `ddlib.simulation.record`."""
        options = {"effects": self.effects, "seed": self.seed, **options}
        return record(self.arm, self.controller, extents_deg, **options)

    def repeated(self, seed: int) -> Setup:
        """The same experiment on another day: torque noise and the encoders' zero by `seed`.

        Rounding is no noise: without another zero every recording would round alike.
        """
        seed_number("seed", seed)
        steps = [effect.step for effect in self.effects.encoder if hasattr(effect, "step")]
        zero = np.random.default_rng((seed, len(steps))).uniform(0.0, max(steps, default=0.0), 2)
        shifted = (EncoderZero(tuple(zero)), *self.effects.encoder, EncoderZero(tuple(-zero)))
        effects = replace(self.effects, encoder=shifted if steps else self.effects.encoder)
        return replace(self, effects=effects, seed=seed)


POSITION_FEEDBACK = Setup("position feedback", proportional(KP))
"""First reading of "a proportional controller": torque proportional to the position error."""

STATE_FEEDBACK = Setup("state feedback", pd(KP, KD))
"""Second reading: the reference is "position and velocity" (section 2), so the torque is
proportional to the errors in both. The arm follows without ringing."""

JOINT_DAMPING_KP = (750.0, 225.0)
"""Gains of `JOINT_DAMPING`, N m/rad: 2.5 times `KP`. Tuned to Table 4-1."""

JOINT_DAMPING_VISCOUS = (5.3, 1.1)
"""Viscous friction of `JOINT_DAMPING`, N m s/rad: what public code gives for the IMI arm, another
planar direct-drive arm. Not tuned."""

JOINT_DAMPING_COULOMB = (1.5, 0.45)
"""Coulomb friction of `JOINT_DAMPING`, N m: three times the default. Tuned to Table 4-1."""

JOINT_DAMPING_BITS = 12.5
"""Encoder of `JOINT_DAMPING`, bits: the 16 that are remembered cannot make the training error at
window 11. Tuned to Table 4-1."""

JOINT_DAMPING_STEPS = 120
"""Levenberg-Marquardt steps of `JOINT_DAMPING`, with white inputs (`ddlib.learning.solve`): it is
stopped there, not converged. Method and number are tuned."""

JOINT_DAMPING_DECAY = 1e-6
"""Weight decay of `JOINT_DAMPING`. Tuned; it decides the size of the largest weights."""

JOINT_DAMPING = Setup(
    "joint damping",
    proportional(JOINT_DAMPING_KP),
    effects=replace(
        CMU_DD_ARM_II_EFFECTS,
        friction=(ViscousFriction(JOINT_DAMPING_VISCOUS), CoulombFriction(JOINT_DAMPING_COULOMB)),
        encoder=(Quantisation(2 * np.pi / 2**JOINT_DAMPING_BITS),),
    ),
    steps=JOINT_DAMPING_STEPS,
    decay=JOINT_DAMPING_DECAY,
)
"""Third reading: torque proportional to the position error alone, and joints that are damped by
themselves. Arm and torque noise are the default ones."""

LITERATURE = replace(
    POSITION_FEEDBACK,
    name="joint damping, nothing tuned",
    effects=replace(
        CMU_DD_ARM_II_EFFECTS,
        friction=(ViscousFriction(JOINT_DAMPING_VISCOUS), *CMU_DD_ARM_II_EFFECTS.friction[1:]),
    ),
)
"""The same idea with nothing tuned to the table: `POSITION_FEEDBACK` with the IMI arm's viscous
friction; gains, Coulomb friction, 16 bits and training are the default ones."""

SETUPS = {setup.name: setup for setup in (POSITION_FEEDBACK, STATE_FEEDBACK, JOINT_DAMPING)}
"""The three readings of "a proportional controller" by name."""


def split(recording: Recording) -> tuple[Recording, Recording]:
    """Training runs 1 to 5 and test run 6 of an Appendix I recording: split by trajectory."""
    instance("recording", recording, Recording)
    if recording.q.ndim != 3 or len(recording.q) != len(APPENDIX_I):
        raise ValueError(
            f"recording must hold the six runs of Appendix I, got shape {recording.q.shape}"
        )
    return recording[:5], recording[5]


def train_windows(
    setup: Setup,
    recording: Recording,
    width: int,
    members: int,
    *,
    seed=0,
    snapshots=(),
    whiten=True,
    progress=True,
) -> tuple[TorqueModel, History, dict[int, Weights]]:
    """Train networks of one window size on runs 1 to 5 of Appendix I, following run 6.

    `seed` is of the first network's weights; `snapshots`, `progress` and what is returned are those
    of `ddlib.learning.train_ensemble`. A set-up with Levenberg-Marquardt `steps` has no snapshots;
    `whiten` is that of `ddlib.learning.solve`.
    """
    from ddlib.learning import solve, train_ensemble

    integer("members", members, 1)
    training, test = split(recording)
    data = TrainingSet.from_recording(training, width, scaling=setup.scaling)
    weights = Weights.random(members, width, setup.hidden, initial=setup.initial, seed=seed)
    shared = {
        "test": data.transform(*cases(test, width)),
        "progress": progress,
        "label": f"{setup.name}, window {width}",
    }
    if setup.steps:
        how = {"decay": setup.decay, "steps": setup.steps, "whiten": whiten}
        solution = solve(weights, data, **how, **shared)
        return solution.model, solution.history, {}
    return train_ensemble(
        weights,
        data,
        rate=setup.rate / width,
        momentum=setup.momentum,
        epochs=setup.epochs,
        warm_up=setup.warm_up,
        snapshots=snapshots,
        **shared,
    )


@dataclass(frozen=True)
class AppendixErrors:
    """RMSS on an Appendix I recording, in each way the paper may have meant."""

    training: np.ndarray  #: Pooled, divided by the training set's own deviation.
    test: np.ndarray  #: Of trajectory 6, pooled, divided by its own deviation.
    by_training_deviation: np.ndarray  #: Of trajectory 6, divided by the training set's deviation.
    shoulder: np.ndarray  #: Of trajectory 6, one joint.
    elbow: np.ndarray  #: Of trajectory 6, one joint.
    desired: np.ndarray  #: Of trajectory 6, from the reference in place of measured positions.

    def named(self) -> dict[str, np.ndarray]:
        """The same under the names that results and tables use."""
        return {_NAMES[field.name]: getattr(self, field.name) for field in fields(self)}


# What results and tables call the fields of `AppendixErrors`
_NAMES = {
    "training": "training",
    "test": "test",
    "by_training_deviation": "test by training deviation",
    "shoulder": "test shoulder",
    "elbow": "test elbow",
    "desired": "test, desired positions",
}


def errors(model: TorqueModel, recording: Recording) -> AppendixErrors:
    """RMSS of a model on an Appendix I recording, one value per member each.

    Of what is returned `training` and `test` are as in Table 4-1; `shoulder`, `elbow`, `desired`
    (the reference in place of measured positions) and `by_training_deviation` are other readings
    of `test`. `named()` gives all by the names that tables use.
    """
    instance("model", model, TorqueModel)
    instance("recording", recording, Recording)
    width = model.weights.width
    training, test = split(recording)
    (x, y), (x6, y6) = cases(training, width), cases(test, width)
    desired = sliding_windows(test.reference.q, width, test.motion)
    predicted = model.torque(x6)
    by_joint = rmss(predicted, y6, pooled=False)
    return AppendixErrors(
        training=rmss(model.torque(x), y),
        test=rmss(predicted, y6),
        by_training_deviation=rmss(predicted, y6, scale=y.std(0)),
        shoulder=by_joint[..., 0],
        elbow=by_joint[..., 1],
        desired=rmss(model.torque(desired), y6),
    )


def predict(model: TorqueModel, recording: Recording) -> np.ndarray:
    """Torque that a model gives along the motion of a recording, ``(..., time, joint)``, N m.

    A model that knows its sampling period refuses a recording with another one.
    """
    instance("model", model, TorqueModel)
    instance("recording", recording, Recording)
    finite_array("recording.q", recording.q, 2)
    if model.step is not None and abs(recording.step / model.step - 1) > 1e-6:
        raise ValueError(
            f"recording must have the model's sampling period of {model.step:g} s, "
            f"got {recording.step:g} s"
        )
    return model.torque(sliding_windows(recording.q, model.weights.width, recording.motion))


def true_states(recording: Recording, setup: Setup, skip: float = 0.0) -> np.ndarray:
    """What perfect sensors would have read in the motion, ``(..., samples, joint, 3)``.

    Position (rad), velocity and acceleration, which the setup's arm and friction give from the
    torque. The first `skip` s of the motion, where the transient is, may be left out.
    """
    instance("recording", recording, Recording)
    instance("setup", setup, Setup)
    motion, (begin, end) = recording.motion, recording.span
    number("skip", skip, 0.0, end - begin - recording.step)
    inside = slice(motion.start + round(skip / recording.step), motion.stop)
    q, qd, tau = (
        x[..., inside, :] for x in (recording.q_true, recording.qd_true, recording.tau_true)
    )
    driving = tau - setup.effects.friction_torque(qd)
    return np.stack([q, qd, setup.arm.forward_dynamics(q, qd, driving)], -1)
