"""What a check of a recording finds, over ensembles of recordings with and without each defect."""

import time
import warnings
from collections import Counter
from dataclasses import fields, replace
from functools import cache

import numpy as np
import pytest

from ddlib import figures
from ddlib.control import pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II, Arm, Link
from ddlib.effects import (
    CoulombFriction,
    Effects,
    Noise,
    Quantisation,
    Saturation,
    ViscousFriction,
)
from ddlib.identification import by_kalman, by_modulation, least_squares
from ddlib.logs import (
    DoubtfulRecording,
    Log,
    LoggedRecording,
    LoggedRun,
    check_recording,
    warn_of,
)
from ddlib.logs._readings import spikes
from ddlib.logs.findings import SEVERITIES, in_runs
from ddlib.setups import SETUPS
from ddlib.simulation import record
from ddlib.trajectories import random_extents
from workshop.report.results import BOOK

SMALL = Arm.from_links("small", Link(4.0, 0.35, 0.16, 0.05), Link(2.5, 0.30, 0.14, 0.025))
ARMS = {
    "CMU": (CMU_DD_ARM_II, 1.0),
    "CMU, vertical": (replace(CMU_DD_ARM_II, gravity_moments=(30.0, 10.0)), 1.0),
    "small": (SMALL, 0.2),
    "small, hanging": (replace(SMALL, gravity_moments=(-15.0, -3.5)), 0.2),
}
# torque noise of the shoulder in units of the arm's, bits of the encoder, gains on velocity
LOGS = {
    "quiet": (0.02, 20, 0.12),
    "noisy": (0.6, 16, 0.12),
    "coarse": (0.163, 12.5, 0.12),
    "without damping": (0.163, 16, 0.0),
}


@cache
def recordings():
    """Sixteen simulated recordings of three motions each: no defect but what sensors do."""
    out = {}
    for name, (arm, size) in ARMS.items():
        friction = (
            ViscousFriction((0.5 * size, 0.15 * size)),
            CoulombFriction((0.5 * size, 0.15 * size)),
        )
        kp = np.array([300.0, 90.0]) * size
        for kind, (noise, bits, damping) in LOGS.items():
            effects = Effects(
                friction=friction,
                actuator=(Saturation((100.0, 30.0)),),
                encoder=(Quantisation(2 * np.pi / 2**bits),),
                torque_sensor=(Noise((noise * size, noise * size / 4)),),
            )
            law = pd(kp, damping * kp) if damping else proportional(kp)
            seed = len(out)
            extents = random_extents(6, seed=seed)[:3]
            out[name, kind] = record(arm, law, extents, effects=effects, seed=seed)
    return out


def changed(recording, q=None, tau=None, t=None):
    """A log of a recording with angles, torques (of one run at a time) or times changed."""
    return Log(
        tuple(
            replace(
                run,
                t=t(run.t) if t else run.t,
                q=q(run.q.copy()) if q else run.q,
                tau=tau(run.tau.copy()) if tau else run.tau,
            )
            for run in in_runs(recording)
        )
    )


def as_recording(log):
    """A log whose runs are equally long, as a recording on its grid."""
    q, tau = (np.stack([getattr(run, name) for run in log.runs]) for name in ("q", "tau"))
    recording = recordings()["CMU", "quiet"]
    return replace(recording, t=log.runs[0].t, q=q, tau=tau)


def moved(rows, value):
    """A change of the shoulder's column in some rows."""

    def change(x):
        x[rows, 0] += value
        return x

    return change


def held(x):
    for begin in range(70, 330, 40):
        x[begin : begin + 6] = x[begin]
    return x


def zeroed(x):
    for begin in range(75, 330, 40):
        x[begin : begin + 3] = 0.0
    return x


def stuck(x):
    x[150:180] = x[150]
    return x


def clipped(x):
    return np.clip(x, *(0.5 * np.abs(x).max(0) * sign for sign in (-1, 1)))


def commanded(recording):
    """The torque as a law computes it from a velocity by differences of noisy readings."""
    rng = np.random.default_rng(1)
    noisy = changed(recording, q=lambda q: q + rng.normal(0.0, 2e-4, q.shape))
    size = np.array([35.0, 10.0])
    return Log(
        tuple(
            replace(run, tau=run.tau - size * np.diff(run.q, axis=0, prepend=run.q[:1]) / 0.01)
            for run in noisy.runs
        )
    )


def locked(recording):
    rng = np.random.default_rng(2)
    return changed(recording, q=lambda q: q * [1, 0] + rng.normal(0, 1e-4, q.shape) * [0, 1])


def wrapped(q):
    """The shoulder read as an absolute encoder does whose zero lies in the middle of the motion."""
    q[:, 0] = (q[:, 0] - np.median(q[:, 0])) % (2 * np.pi) - np.pi
    return q


DEFECTS = {
    "units of time": lambda r: changed(r, t=lambda t: 1000 * t),
    "units of angle": lambda r: changed(r, q=np.rad2deg),
    "wrap": lambda r: changed(r, q=wrapped),
    "spike": lambda r: changed(r, q=moved(137, 0.05)),
    "spike at rest": lambda r: changed(r, q=moved(15, 0.05)),
    "drop-outs (held)": lambda r: changed(r, q=held),
    "drop-outs (zero)": lambda r: changed(r, q=lambda q: zeroed(q + 0.4)),
    "torque held": lambda r: changed(r, tau=stuck),
    "torque zero": lambda r: changed(r, tau=zeroed),
    "saturation": lambda r: changed(r, tau=clipped),
    "no torque": lambda r: changed(r, tau=lambda tau: tau * [1, 0]),
    "at rest": locked,
    "command": commanded,
    "sign of the torque": lambda r: changed(r, tau=np.negative),
    "sign of a torque": lambda r: changed(r, tau=lambda tau: tau * [1, -1]),
    "elbow angle": lambda r: changed(r, q=lambda q: q @ [[1, 1], [0, 1]]),
    "sign of the elbow": lambda r: changed(
        r, q=lambda q: q * [1, -1], tau=lambda tau: tau * [1, -1]
    ),
    "order of the joints": lambda r: changed(r, tau=lambda tau: tau[:, ::-1]),
    "lag": lambda r: changed(r, tau=lambda tau: np.roll(tau, 1, axis=0)),
    "lag, early": lambda r: changed(r, tau=lambda tau: np.roll(tau, -1, axis=0)),
}
SHOWN_BY_NUMBERS = ("units of time", "units of angle", "wrap", "spike", "drop-outs (zero)")

BY_EQUATIONS = (
    "sign of a torque",
    "elbow angle",
    "sign of the elbow",
    "order of the joints",
    "lag",
)


def kinds(check, *severities):
    return {found.kind for found in check.findings if found.severity in severities}


def test_good_recordings_are_not_called_wrong():
    """Of 19, three of the book's own: none wrong; doubtful only what coarse or noisy sensors do."""
    doubtful = Counter()
    every = recordings() | {("book", name): setup.record() for name, setup in SETUPS.items()}
    for (arm, kind), recording in every.items():
        check = check_recording(recording)
        assert not check.wrong, (arm, kind, check)
        doubtful.update(kinds(check, "doubtful"))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warn_of(recording)
        heavy = bool(check.of("gravity"))
        assert heavy == any(ARMS.get(arm, ARMS["CMU"])[0].gravity_moments), (arm, kind)
    # a torque that is computed from a coarse reading has its steps in it, by rights
    assert set(doubtful) <= {"command", "little torque", "spike", "excitation"}
    assert max(doubtful.values()) <= 10


@pytest.mark.parametrize("defect", DEFECTS)
def test_defects_are_found_in_nearly_all_recordings(defect):
    """Fifteen of sixteen by single numbers, twelve by the equations of three short motions.

    Nothing else is called wrong but what the same samples do.
    """
    found, others, warned = 0, Counter(), 0
    kind = defect.removesuffix(" at rest").removesuffix(", early")
    for recording in recordings().values():
        log = DEFECTS[defect](recording)
        check = check_recording(log)
        found += kind in kinds(check, "wrong", "doubtful")
        others.update(kinds(check, "wrong") - {kind, "spike", "sign of the torque"})
        if defect in SHOWN_BY_NUMBERS:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                warn_of(as_recording(log))
            warned += [w.category for w in caught] == [DoubtfulRecording]
    assert found >= (12 if defect in BY_EQUATIONS else 15)
    assert sum(others.values()) <= (16 if defect == "units of time" else 1), others
    assert warned == (16 if defect in SHOWN_BY_NUMBERS else 0)


def test_lag_is_measured_within_its_uncertainty():
    """The logged torque acts for one control period from its sample on: 0.1 samples later."""
    recording = recordings()["CMU", "quiet"]
    (found,) = check_recording(changed(recording, tau=lambda x: np.roll(x, 3, axis=0))).of("lag")
    told, error = found.what.split("read ")[1].split(" samples")[0].split(" ± ")
    assert abs(float(told) - 2.9) < float(error) and "later" in found.what
    assert float(error) < 0.5 and "backlash" in found.advice


def test_spikes_are_rare_in_noise_and_in_steps():
    """One false spike in 300,000 samples or fewer; nearly all of those that are planted."""
    rng = np.random.default_rng(3)
    t = np.arange(3000) * 0.002
    false = found = 0
    for k in range(100):
        w, phase = rng.uniform(1.0, 20.0, (2, 3))
        q = sum(0.5 / (j + 1) * np.sin(w[j] * t + phase[j]) for j in range(3))
        step, noise = ((3.8e-4, 0), (1e-5, 0), (1e-9, 1e-4), (1e-3, 1e-3))[k % 4]
        q = np.round((q + rng.normal(0, noise + 1e-15, q.size)) / step) * step
        false += len(spikes(q)[0])
        at, size = 1000 + k, max(0.02, 30 * noise)
        q[at] += size
        rows, sizes = spikes(q)
        found += at in rows and abs(sizes[rows == at][0] / size - 1) < 0.5
    assert false <= 1 and found >= 97


def test_excitation_names_what_a_locked_elbow_cannot_tell():
    """R1: with the elbow locked, sums of a, b and d act on both joints, but none of the three."""
    rng = np.random.default_rng(4)
    t = np.arange(300) * 0.01
    q1 = 0.5 * np.sin(2 * t) + 0.4 * np.sin(3 * t)
    qdd = np.stack([-2.0 * np.sin(2 * t) - 3.6 * np.sin(3 * t), 0 * t], -1)
    q = np.stack([q1, 0 * t], -1)
    tau = Arm("my arm", 1.0, 0.2, 0.3, (0.3, 0.3)).inverse_dynamics(q, np.zeros((300, 2)), qdd)
    for noise in (0.0, 1e-4):
        read = q + rng.normal(0, 1, q.shape) * [0.0, noise]
        run = LoggedRun("locked", t, read, tau + rng.normal(0, 0.01, tau.shape), None)
        check = check_recording(Log((run,)))
        assert not check.wrong and [f.where for f in check.of("at rest")] == [(0, 1)]
        lost = check.of("excitation")[0].what.partition("It does not tell one by one: ")[2]
        assert {"b", "d"} <= set(lost.rstrip(".").split(", "))


def test_torque_that_is_zero_throughout_is_told_not_refused():
    """R11."""
    log = changed(recordings()["small", "quiet"], tau=lambda tau: tau * [1, 0])
    check = check_recording(log)
    assert len(check.of("no torque")) == 3 and not check.wrong
    both = check_recording(changed(recordings()["small", "quiet"], tau=lambda tau: 0 * tau))
    assert "no torque" in kinds(both, "wrong")


def test_a_command_among_currents_of_a_real_arm_is_found():
    """Currents come in steps; in one run of a design the column holds what was commanded."""
    with np.load(BOOK / "data" / "double-pendulum.npz") as kept:
        logged = {name: kept[name].astype(float) for name in kept.files}

    def run(name, torques):
        x = logged[name]
        return LoggedRun(name, x[:, 0], x[:, 1:3], x[:, torques], np.arange(len(x)) + 2)

    current, command = slice(3, 5), slice(5, 7)
    for design in ("A0", "C0", "C1"):
        names = [name for name in logged if name.startswith(design)]
        check = check_recording(Log(tuple(run(name, current) for name in names)))
        assert not check.wrong and not check.of("command") and check.of("gravity")
        for k in range(len(names)):
            torques = [command if i == k else current for i in range(len(names))]
            mixed = check_recording(Log(tuple(map(run, names, torques))))
            assert {found.where for found in mixed.of("command")} == {(k, 0), (k, 1)}


def test_times_of_a_log():
    run = in_runs(recordings()["CMU", "quiet"])[0]
    rng = np.random.default_rng(5)
    at_60_hz = np.round(np.arange(run.t.size) / 60, 3)
    keep = np.delete(np.arange(run.t.size), slice(150, 175))
    twice = np.insert(np.arange(run.t.size), 100, 100)
    cases = {
        "rounded time": replace(run, t=at_60_hz),
        "jitter": replace(run, t=run.t + rng.uniform(-0.003, 0.003, run.t.size)),
        "gaps": replace(run, t=run.t[keep], q=run.q[keep], tau=run.tau[keep]),
        "repeated time": replace(run, t=run.t[twice], q=run.q[twice], tau=run.tau[twice]),
        "time runs back": replace(run, t=run.t % 1.0),
        "time": replace(run, t=0 * run.t),
    }
    for kind, case in cases.items():
        check = check_recording(Log((case,)))
        assert [f.where for f in check.of(kind)] == [(0, None)], (kind, check)
    gap = check_recording(Log((cases["gaps"],))).of("gaps")[0]
    assert "25 samples missing at 1 place;" in gap.what and gap.rows.tolist() == [150]
    assert "16.67 ms" in check_recording(Log((cases["rounded time"],))).of("rounded time")[
        0
    ].what or ("1 ms" in check_recording(Log((cases["rounded time"],))).of("rounded time")[0].what)


def test_a_spike_is_told_with_its_line_and_drawn():
    recording = recordings()["small", "quiet"]
    log = changed(recording, q=lambda q: q)
    runs = list(log.runs)
    spiked = runs[1].q.copy()
    spiked[137, 0] += 0.5
    runs[1] = replace(runs[1], q=spiked, lines=np.arange(len(spiked)) + 402)
    check = check_recording(Log(tuple(runs)))
    (found,) = check.wrong
    assert (found.kind, found.where, found.rows.tolist()) == ("spike", (1, 0), [137])
    assert found.lines.tolist() == [539] and "0.5 rad" in found.what
    text = repr(check)
    assert "(line 539)" in text and "run 2, shoulder: spike" in text
    assert max(map(len, text.splitlines())) <= 100
    assert check._repr_markdown_().count("\n- ") == len(check._groups())
    order = [SEVERITIES.index(f.severity) for f in check.findings]
    assert order == sorted(order)
    assert figures.checked(check).alt.endswith("run 2. Marked: spike.")
    assert figures.checked(check, 0).alt.endswith("run 1. Marked: nothing.")
    with pytest.raises(ValueError, match=r"run must be an integer from 0 to 2, got 3"):
        figures.checked(check, 3)


def test_what_is_missing_is_told():
    recording = recordings()["CMU", "quiet"]
    log = changed(recording, q=moved(slice(100, 110), np.nan))
    check = check_recording(log)
    assert not check.wrong and len(check.of("missing")) == 3
    assert check.of("missing")[0].rows.tolist() == list(range(100, 110))


def test_what_is_no_recording_is_refused():
    with pytest.raises(TypeError, match="recording must be a Recording, a LoggedRecording or a L"):
        check_recording(np.zeros((5, 2)))
    recording = recordings()["CMU", "quiet"]
    with pytest.raises(
        ValueError, match=r"q and tau of shape \(\.\.\., 400, 2\), got \(3, 400, 1\)"
    ):
        check_recording(replace(recording, q=recording.q[..., :1]))
    assert "0 runs" in repr(check_recording(Log(())))


def test_a_logged_recording_knows_its_lines_and_a_warning_is_one_line():
    plain = recordings()["small", "quiet"]
    q = plain.q.copy()
    q[2, 200, 1] -= 0.3
    parts = {name: getattr(plain, name) for name in plain.__dataclass_fields__} | {"q": q}
    lines = np.arange(q[..., 0].size).reshape(q.shape[:2]) + 2
    logged = LoggedRecording(**parts, names=tuple("abc"), lines=lines)
    assert check_recording(logged).wrong[0].lines.tolist() == [lines[2, 200]]
    with pytest.warns(DoubtfulRecording, match=r"spike \(run 3, elbow\)") as caught:
        warn_of(logged)
    assert len(caught) == 1 and "\n" not in str(caught[0].message)
    assert len(str(caught[0].message)) < 300


def test_a_warning_costs_little_of_a_fit():
    """A tenth of a fit when idle; a fifth at most is asserted, as other work may interfere."""
    recording = recordings()["small", "noisy"]

    def fastest(call):
        times = []
        for _ in range(15):
            begin = time.perf_counter()
            call()
            times.append(time.perf_counter() - begin)
        return min(times)

    fit = fastest(lambda: least_squares(by_modulation(recording)))
    assert fastest(lambda: warn_of(recording)) < 0.2 * fit


def test_fits_to_a_log_warn_of_what_makes_them_wrong():
    sound = recordings()["CMU", "quiet"]
    log = LoggedRecording(**{f.name: getattr(sound, f.name) for f in fields(sound)})
    q = log.q.copy()
    q[0, 200, 0] += 0.5
    for fit in (by_modulation, by_kalman):
        with warnings.catch_warnings():
            warnings.simplefilter("error", DoubtfulRecording)
            fit(log)
            fit(replace(sound, q=q))  # simulated: it is what it is
        with pytest.warns(DoubtfulRecording, match=r"spike \(run 1, shoulder\)") as told:
            fit(replace(log, q=q))
        assert told[0].filename == __file__ or fit is by_kalman
