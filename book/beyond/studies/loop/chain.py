"""Arms of one to seven joints on the report's family of motions: recordings without a simulator.

Each joint answers its reference as its own loop would if the others did not move it, a linear
oscillator; the torque is what the whole arm needs along that motion, friction and noise included.
How joints push each other off their ways is left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.linalg import expm

from ddlib._check import shaped
from ddlib.dynamics import DD_ARM_II_IN_SPACE, SerialArm, locked, mass_matrix
from ddlib.effects import EncoderZero, Quantisation
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK
from ddlib.simulation import LOG_STEP
from ddlib.trajectories import MAX_EXTENT_DEG, MOTION_SECONDS

_MOST = DD_ARM_II_IN_SPACE.joints  # six as the real arm, and one of the book's
RATIOS = (0.8, 1.15, 0.9, 1.25, 0.7)  # frequencies of joints 3 to 7 over the elbow's; assumed
_NOISE = 0.024  # torque noise of joints 3 to 7 over their torque's deviation, as of the first two
REACH = 10  # samples of a window on either side of its centre
SPACING = 5  # samples from tap to tap: 5 of the report's 21
EVERY = 2  # samples from the centre of a window to the next
MOTIONS = ("answered", "sine")  # by the joints' own loops; the reference's sine, without an end


@dataclass(frozen=True)
class Chain:
    """An arm with all that a recording of it needs; arrays are joint by joint."""

    arm: SerialArm
    frequency: np.ndarray  # of the joints' loops, rad/s
    damping: np.ndarray  # as a share of the critical one
    lead: np.ndarray  # share of the damping that acts on the error in velocity
    viscous: np.ndarray  # N m s/rad
    coulomb: np.ndarray  # N m
    smoothing: float  # speed over which Coulomb friction turns, rad/s
    encoder: float  # step, rad
    noise: np.ndarray  # deviation, N m

    @property
    def joints(self) -> int:
        """Number of joints."""
        return self.arm.joints

    def torque(self, states) -> np.ndarray:
        """Torque along exact states ``(..., joint, 3)``, friction included, N m."""
        q, qd, qdd = np.moveaxis(states, -1, 0)
        friction = self.viscous * qd + self.coulomb * np.tanh(qd / self.smoothing)
        return self.arm.inverse_dynamics(q, qd, qdd) + friction

    def answer(self, t_steps: int, before: int, motion: str = "answered") -> np.ndarray:
        """States ``(t_steps, joint, 3)`` that answer 1 rad, asked for after `before` samples."""
        omega = np.pi / MOTION_SECONDS
        if motion == "sine":
            t = omega * LOG_STEP * (np.arange(t_steps) - before)
            states = np.stack([-np.sin(t), -omega * np.cos(t), omega**2 * np.sin(t)], -1)
            return np.repeat(states[:, None], self.joints, 1)
        end = round(MOTION_SECONDS / LOG_STEP)
        response = np.zeros((t_steps, self.joints, 3))
        for j, (f, z, lead) in enumerate(zip(self.frequency, self.damping, self.lead)):
            pull = [-(f**2), -2 * z * f, f**2, 2 * z * f * lead]
            flow = np.array([[0, 1, 0, 0], pull, [0, 0, 0, 1], [0, 0, -(omega**2), 0]])
            step, state = expm(flow * LOG_STEP), np.array([0.0, 0.0, 0.0, -omega])
            for k in range(t_steps - before):
                if k == end:
                    state[2:] = 0.0
                response[before + k, j] = *state[:2], flow[1] @ state
                state = step @ state
        return response


@cache
def chain(joints: int, reading: str = JOINT_DAMPING.name) -> Chain:
    """The arm with its first joints free and the others locked, in a reading of the controller.

    Shoulder and elbow have its gains, friction and encoder. Further joints have the elbow's damping
    ratio, frequencies by `RATIOS`, and friction in proportion to their inertia.
    """
    inertia = np.diag(mass_matrix(DD_ARM_II_IN_SPACE, np.zeros(_MOST)))
    setup = {setup.name: setup for setup in (JOINT_DAMPING, STATE_FEEDBACK)}[reading]
    kp, kd = np.array(setup.controller.kp), np.zeros(2) + setup.controller.kd
    rubbing, (encoder,) = setup.effects.friction, setup.effects.encoder
    viscous, coulomb = np.array(rubbing[0].coefficient), np.array(rubbing[1].level)
    frequency = np.sqrt(kp / inertia[:2])
    damping = (kd + viscous) / (2 * inertia[:2] * frequency)
    frequency = np.append(frequency, frequency[1] * np.array(RATIOS))
    share = inertia[2:] / inertia[1]
    viscous = np.append(viscous, viscous[1] * share * RATIOS)
    coulomb = np.append(coulomb, coulomb[1] * share)
    lead = kd / (kd + viscous[:2])
    (noise,) = setup.effects.torque_sensor
    result = Chain(
        locked(DD_ARM_II_IN_SPACE, joints),
        frequency[:joints],
        np.append(damping, [damping[1]] * 5)[:joints],
        np.append(lead, [lead[1]] * 5)[:joints],
        viscous[:joints],
        coulomb[:joints],
        rubbing[1].smoothing,
        encoder.step,
        np.append(noise.std, np.zeros(5))[:joints],
    )
    tau = result.torque(moved(result, extents(joints, 64, 0))[:, ::5])
    result.noise[2:] = _NOISE * tau.std((0, 1))[2:]
    return result


def extents(joints: int, motions: int, seed: int) -> np.ndarray:
    """Extents as in Appendix I, degrees; the first of a longer draw are those of a shorter one."""
    return np.random.default_rng((seed, joints)).uniform(0.0, MAX_EXTENT_DEG, (motions, joints))


def moved(chain: Chain, extents_deg, motion: str = "answered") -> np.ndarray:
    """True states ``(runs, time, joint, 3)`` of motions with `REACH` samples of rest around."""
    extents_deg = shaped("extents_deg", extents_deg, f"(runs, {chain.joints})")
    samples = round(MOTION_SECONDS / LOG_STEP) + 2 * REACH
    unit = chain.answer(samples, REACH, motion)
    return np.deg2rad(extents_deg)[:, None, :, None] * unit


@dataclass(frozen=True)
class Sample:
    """Cases of motions: what networks see, the torque that is measured, and the truth."""

    windows: np.ndarray  # (cases, joint, taps): measured positions, rad
    torque: np.ndarray  # (cases, joint): measured, N m
    states: np.ndarray  # (cases, joint, 3): true ones at the centres
    runs: int  # motions; each has as many cases, one after the other

    @property
    def pair(self) -> tuple[np.ndarray, np.ndarray]:
        """Windows and torque."""
        return self.windows, self.torque

    def thinned(self, most: int) -> Sample:
        """At most so many cases: of every motion each k-th."""
        step = -(-len(self.torque) // most)
        return Sample(*(x[::step] for x in (self.windows, self.torque, self.states)), self.runs)


def recorded(
    chain: Chain, extents_deg, seed: int, motion: str = "answered", spacing: int = SPACING
) -> Sample:
    """Follow motions ``(runs, joint)`` exactly, and cut what is measured into windows.

    ``seed`` draws the torque noise and the encoder's zero; ``spacing`` are samples from one tap of
    a window to the next.
    """
    states = moved(chain, extents_deg, motion)
    rng = np.random.default_rng((seed, 7))
    zero = tuple(rng.uniform(0.0, chain.encoder, chain.joints))
    read = states[..., 0]
    for effect in (EncoderZero(zero), Quantisation(chain.encoder), EncoderZero(-np.array(zero))):
        read = effect.apply(read)
    runs, samples = read.shape[:2]
    centres = np.arange(REACH, samples - REACH, EVERY)
    taps = centres[:, None] + np.arange(-REACH, REACH + 1, spacing)
    windows = np.moveaxis(read[:, taps], -1, -2).reshape(-1, chain.joints, taps.shape[1])
    true = states[:, centres]
    tau = chain.torque(true)
    tau = tau + rng.standard_normal(tau.shape) * chain.noise
    joints = chain.joints
    return Sample(windows, tau.reshape(-1, joints), true.reshape(-1, joints, 3), runs)
