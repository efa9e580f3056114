"""What a check of a recording finds, over ensembles of recordings with and without each defect."""

from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.signal import savgol_filter

from ddlib import figures
from ddlib.control import pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II, Arm, Link
from ddlib.effects import CoulombFriction, Effects, Noise, Quantisation, ViscousFriction
from ddlib.identification import (
    FRICTION,
    GRAVITY,
    OFFSETS,
    RIGID,
    by_modulation,
    check_recording,
    least_squares,
)
from ddlib.logs import Log, LoggedRun, resample
from ddlib.logs.findings import SEVERITIES
from ddlib.setups import SETUPS
from ddlib.simulation import record
from ddlib.trajectories import random_extents
from workshop.report.results import BOOK

SOUND, FEW = 200, 10


def arm_of(rng, hangs) -> Arm:
    (m1, m2), (l1, l2) = rng.uniform([2, 1], [8, 5]), rng.uniform([0.25, 0.2], [0.5, 0.45])
    places = rng.uniform(0.4, 0.55, 2) * [l1, l2]
    links = (
        Link(m, size, com, m * size**2 / 9) for m, size, com in zip((m1, m2), (l1, l2), places)
    )
    return Arm.from_links("one", *links, 9.81 * hangs)


@cache
def swinging(seed):
    """A log of an arm whose joints swing by three sines, from the equations of motion alone."""
    rng = np.random.default_rng(seed)
    hangs, step = seed % 2 == 1, rng.choice([0.002, 0.004, 0.01])
    arm, t = arm_of(rng, hangs), step * np.arange(int(5 / step))
    speed = rng.uniform(2, 7, (2, 3, 1, 2))  # runs, sines, time, joint
    angle = speed * t[:, None] + rng.uniform(0, 6, speed.shape)
    size = rng.uniform(0.1, 0.35, (3, 1, 2))
    q, v, a = (
        (size * x).sum(1)
        for x in (np.sin(angle), speed * np.cos(angle), -(speed**2) * np.sin(angle))
    )
    q = q + rng.uniform(-0.4, 0.4, 2)
    tau = arm.inverse_dynamics(q, v, a)
    tau += rng.uniform(0.02, 0.15) * tau.std((0, 1)) * np.tanh(v / 0.02)
    tau += rng.uniform(0, 0.15) * tau.std((0, 1)) * v / v.std((0, 1))
    tau += rng.uniform(0.01, 0.1) * tau.std((0, 1)) * rng.standard_normal(tau.shape)
    grain = 2 * np.pi / 2 ** rng.uniform(14, 20)
    runs = (LoggedRun(f"{k}", t, np.round(x / grain) * grain, y, 2 + np.arange(t.size))
            for k, (x, y) in enumerate(zip(q, tau)))  # fmt: skip
    return hangs, resample(Log(tuple(runs)))


@cache
def driven(seed):
    """A simulated recording of six motions from point to point."""
    rng = np.random.default_rng(seed)
    hangs = bool(rng.integers(2))
    arm = CMU_DD_ARM_II if seed % 4 == 0 else arm_of(rng, hangs)
    if seed % 4 == 0 and hangs:
        arm = replace(arm, gravity_moments=(30.0, 10.0))
    size = arm.a / CMU_DD_ARM_II.a
    friction = size * rng.uniform(0.1, 0.3, (2, 2)) * [[3.0, 1.0], [1.5, 0.5]]
    noise, damping = size * rng.uniform(0.02, 0.4), rng.choice([0, 0.06, 0.12])
    kp = np.array([300.0, 90.0]) * size * rng.uniform(0.6, 1.5)
    effects = Effects(
        friction=(ViscousFriction(tuple(friction[0])), CoulombFriction(tuple(friction[1]))),
        encoder=(Quantisation(2 * np.pi / 2 ** rng.uniform(13, 20)),),
        torque_sensor=(Noise((noise, noise / 4)),),
    )
    law = pd(kp, damping * kp) if damping else proportional(kp)
    return hangs, record(arm, law, random_extents(6, seed=seed), effects=effects, seed=seed)


def names(hangs):
    return RIGID + FRICTION + GRAVITY * hangs


def kinds(check, *severities):
    return {found.kind for found in check.findings if found.severity in severities}


def changed(q=None, tau=None):
    """A change of the angles, the torques or both, (runs, time, 2)."""
    same = np.copy
    return lambda r: replace(r, q=(q or same)(r.q.copy()), tau=(tau or same)(r.tau.copy()))


def turned(shoulder, elbow):
    return changed(q=lambda q: q + np.deg2rad([shoulder, elbow]))


def spiked(tau):
    tau[1, tau.shape[1] // 2, 0] -= 4 * tau[..., 0].std()
    return tau


def zeroed(tau):
    middle = len(tau[1]) // 4
    row = middle + np.abs(tau[1, middle : 2 * middle, 0]).argmax()
    tau[1, row : row + 3, 0] = 0.0
    return tau


def geared(recording):
    """A rotor behind a gear, which asks for half as much as the elbow's torque has."""
    width = max(int(0.06 / recording.step) // 2 * 2 + 1, 5)
    faster = savgol_filter(recording.q[..., 1], width, 3, 2, axis=1)
    more = 0.5 * recording.tau[..., 1].std() * faster / faster.std()
    return replace(recording, tau=recording.tau + more[..., None] * [0, 1])


BY_EQUATIONS = {
    "zero of the shoulder": turned(90, 0),
    "zero of the shoulder, 10": turned(-10, 0),
    "zero of the shoulder, 180": turned(180, 0),
    "zero of the elbow": turned(0, 90),
    "zero of the elbow, 180": turned(0, 180),
    "zero of the elbow, 15": turned(0, -15),
    "order of the joints": changed(lambda q: q[..., ::-1], lambda tau: tau[..., ::-1]),
    "order of the angles": changed(lambda q: q[..., ::-1]),
    "order of the torques": changed(tau=lambda tau: tau[..., ::-1]),
    "elbow angle": changed(lambda q: q @ [[1, 1], [0, 1]]),
    "sign of the elbow": changed(lambda q: q * [1, -1], lambda tau: tau * [1, -1]),
    "sign of a torque": changed(tau=lambda tau: tau * [1, -1]),
    "sign of a torque, the shoulder's": changed(tau=lambda tau: tau * [-1, 1]),
    "sign of a torque, both": changed(tau=np.negative),
    "sign of an angle": changed(lambda q: q * [1, -1]),
    "sign of an angle, the shoulder's": changed(lambda q: q * [-1, 1]),
    "scale of a torque": changed(tau=lambda tau: tau * [1, 1.25]),
    "scale of a torque, much": changed(tau=lambda tau: tau * [1, 6]),
    "scale of a torque, the shoulder's": changed(tau=lambda tau: tau * [1.25, 1]),
    "geared motor": geared,
    "torque offset": changed(tau=lambda tau: tau + 0.3 * tau.std((0, 1))),
    "torque spike": changed(tau=spiked),
    "torque zero": changed(tau=zeroed),
    "units of angle": changed(np.rad2deg),
    "units of angle, the shoulder's": changed(lambda q: q * [180 / np.pi, 1]),
    "units of angle, the elbow's": changed(lambda q: q * [1, 180 / np.pi]),
    "lag": changed(tau=lambda tau: np.roll(tau, 3, axis=1)),
    "lag, early": changed(tau=lambda tau: np.roll(tau, -3, axis=1)),
}


@pytest.mark.parametrize("made", [swinging, driven])
def test_sound_recordings_are_not_called_wrong(made):
    """None of 200; doubtful is at most the torque that a controller computed, by rights."""
    doubtful = Counter()
    for seed in range(SOUND if made is swinging else FEW):
        hangs, recording = made(seed)
        check = check_recording(recording, names(hangs))
        assert not check.wrong, (seed, check)
        doubtful.update(kinds(check, "doubtful"))
    assert set(doubtful) <= ({"command"} if made is driven else set()), doubtful


@pytest.mark.parametrize("defect", BY_EQUATIONS)
def test_defects_are_found(defect):
    """In nine of ten recordings of either kind, or more."""
    kind = defect.partition(",")[0]
    for made in (swinging, driven):
        found = tried = 0
        for seed in range(FEW):
            hangs, recording = made(seed)
            if kind == "zero of the shoulder" and not hangs:
                continue
            check = check_recording(BY_EQUATIONS[defect](recording), names(hangs))
            found += kind in kinds(check, "wrong", "doubtful")
            tried += 1
        assert found >= 0.9 * tried, (made, found, tried)


def test_gravity_that_is_not_named_is_wrong():
    for made in (swinging, driven):
        for seed in range(FEW):
            hangs, recording = made(seed)
            assert ("gravity" in kinds(check_recording(recording), "wrong")) == hangs


def test_the_ratio_of_two_torques_is_told():
    hangs, recording = swinging(1)
    for ratio in (0.15, 0.8, 6.0):
        check = check_recording(replace(recording, tau=recording.tau * [1, ratio]), names(hangs))
        (found,) = check.of("scale of a torque")
        told = float(found.what.split("be ")[1].split(" times")[0])
        assert told == pytest.approx(ratio, rel=0.03)


def test_the_angle_of_a_wrong_zero_is_told_and_mends_it():
    _, recording = swinging(1)
    wrong = turned(90, -20)(recording)
    shoulder, elbow = check_recording(wrong, names(True)).wrong
    told = [float(f.advice.split("Add ")[1].split("°")[0]) for f in (shoulder, elbow)]
    np.testing.assert_allclose(told, [-90, 20], atol=1.5)
    mended = replace(wrong, q=wrong.q + np.deg2rad(told))
    assert not check_recording(mended, names(True)).wrong


def test_an_offset_among_the_parameters_is_none_of_the_check():
    _, recording = swinging(0)
    offset = 0.3 * recording.tau.std((0, 1))
    off = replace(recording, tau=recording.tau + offset)
    every = RIGID + FRICTION + OFFSETS
    assert not check_recording(off, every).of("torque offset")
    fit = least_squares(by_modulation(off, every))
    assert (np.abs(fit.values[-2:] - offset) < 4 * fit.errors[-2:]).all()


def test_a_lag_is_measured_within_its_uncertainty():
    _, recording = swinging(2)
    (lag,) = check_recording(changed(tau=lambda x: np.roll(x, 3, axis=1))(recording)).of("lag")
    told, error = lag.what.split("read ")[1].split(" ms")[0].split(" ± ")
    assert abs(float(told) - 3000 * recording.step) < float(error) + 0.1
    assert "later" in lag.what and float(error) < 1000 * recording.step


def test_two_joints_of_a_larger_arm():
    _, recording = swinging(0)
    (found,) = check_recording(replace(recording, joints=6)).findings
    assert found.kind == "larger arm" and "Pinocchio" in found.advice


def test_a_shoulder_that_is_held_gives_way_and_has_no_wrong_sign():
    for seed in range(0, 12, 2):
        rng, t = np.random.default_rng(seed), 0.005 * np.arange(1200)
        arm, speed = arm_of(rng, False), rng.uniform(2, 7, (3, 1))
        angle = speed * t + rng.uniform(0, 6, (3, 1))
        waves = np.sin(angle), speed * np.cos(angle), -(speed**2) * np.sin(angle)
        q, v, a = (np.stack([0 * t, 0.3 * x.sum(0)], -1) for x in waves)
        q[:, 0] = -arm.inverse_dynamics(q, v, a)[:, 0] / 60.0  # a spring holds it
        v[:, 0] = np.gradient(q[:, 0], 0.005)
        a[:, 0] = np.gradient(v[:, 0], 0.005)
        tau = arm.inverse_dynamics(q, v, a)
        tau += rng.normal(0, 0.03 * tau.std(0), tau.shape)
        log = resample(Log((LoggedRun("held", t, q, tau, 2 + np.arange(t.size)),)))
        assert not check_recording(log).wrong, seed
        assert check_recording(changed(tau=np.negative)(log)).of("sign of a torque"), seed


def test_recordings_of_the_book_and_of_a_real_arm():
    for setup in SETUPS.values():
        assert not check_recording(setup.record()).wrong
    with np.load(BOOK / "data" / "double-pendulum.npz") as kept:
        for design in ("A0", "C0", "C1"):
            logged = [kept[name].astype(float)[:4900] for name in kept.files if design in name]
            runs = (
                LoggedRun(design, x[:, 0], x[:, 1:3], x[:, 3:5], np.arange(len(x))) for x in logged
            )
            recording = resample(Log(tuple(runs)), step=0.002)
            assert not check_recording(recording, names(True)).wrong
            assert check_recording(recording).of("gravity")


def test_a_check_is_read_and_drawn():
    _, recording = swinging(0)
    q = recording.q.copy()
    q[1, 137, 0] += 0.5
    check = check_recording(replace(recording, q=q))
    (found,) = check.of("spike")
    assert (found.run, found.joint, list(found.rows), list(found.lines)) == (1, 0, [137], [139])
    text = repr(check)
    assert "(line 139)" in text and "run 2, shoulder: spike" in text and "0.5 rad" in text
    assert max(map(len, text.splitlines())) <= 100
    assert check._repr_markdown_().count("\n- ") == text.count("\n\n")
    order = [SEVERITIES.index(f.severity) for f in check.findings]
    assert order == sorted(order)
    assert figures.checked(check).alt.endswith("run 2. Marked: spike.")
    assert figures.checked(check, 0).alt.endswith("run 1. Marked: nothing.")


def test_what_is_no_recording_is_refused():
    _, recording = swinging(0)
    with pytest.raises(TypeError, match="recording must be of class Recording"):
        check_recording(np.zeros((5, 2)))
    with pytest.raises(ValueError, match=r"q and tau of shape \(\.\.\., \d+, 2\), got"):
        check_recording(replace(recording, q=recording.q[..., :1]))
    with pytest.raises(ValueError, match="recording must have finite tau"):
        check_recording(replace(recording, tau=recording.tau * np.nan))
