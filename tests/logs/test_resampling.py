"""Logs on an even grid: known motions under rounded, jittered and missing stamps."""

import warnings

import numpy as np
import pytest

from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.identification import (
    RIGID,
    FilteredEquations,
    by_modulation,
    by_smoothing,
    least_squares,
)
from ddlib.learning import cases
from ddlib.logs import DoubtfulRecording, Log, LoggedRun, LogWarning, read_csv, resample, write_csv
from ddlib.simulation import record

N = 400
STEP = 0.01


def angles(t):
    return np.stack([0.5 * np.sin(4 * t), 0.4 * np.cos(7 * t + 1)], -1)


def torques(t):
    return np.stack([2 * np.cos(3 * t), np.sin(5 * t)], -1)


def run(stamps, taken=None, name="own.csv"):
    """A run whose samples were `taken` at other times than their stamps say."""
    stamps = np.asarray(stamps, float)
    taken = stamps if taken is None else taken
    return LoggedRun(name, stamps, angles(taken), torques(taken), 2 + np.arange(len(stamps)))


def jittered(share):
    return STEP * (np.arange(N) + share * np.random.default_rng(0).uniform(-1, 1, N))


@pytest.fixture(autouse=True)
def no_warnings():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


@pytest.mark.parametrize("stamps", [
    STEP * np.arange(N), 12.5 + np.arange(N) / 300, np.cumsum(np.full(N, 0.004)),
])  # fmt: skip
def test_even_stamps_come_through_to_the_last_bit(stamps):
    recording = resample(Log((run(stamps),), ("said before.",)))
    assert (recording.t == stamps).all() and recording.notes == ("said before.",)
    assert (recording.q[0] == angles(stamps)).all() and (recording.tau[0] == torques(stamps)).all()
    assert recording.motion == slice(0, N) and recording.control_step == 0
    assert np.isnan(recording.tracking_error).all() and np.isnan(recording.tau_true).all()
    assert repr(recording).endswith("s)\n- said before.")


@pytest.mark.parametrize("rate, grain, rounding", [
    (60, 1e-3, np.round), (60, 1e-3, np.floor), (333, 1e-3, np.round), (125, 1e-3, np.ceil),
    (83, 1e-2, np.floor), (70, 1e-2, np.floor), (100, 2.0**-7, np.round),
])  # fmt: skip
def test_rounded_stamps_stand_for_even_steps(rate, grain, rounding):
    """No sample changes, and the step is the mean one, to a rounding at each end.

    At 83 Hz all stamps are whole multiples of 10 ms, as if samples were missing at 100 Hz; only
    angles can tell. Stamps of single precision are rounded to a power of two.
    """
    taken = np.arange(N) / rate
    stamps = rounding(taken / grain) * grain
    recording = resample(Log((run(stamps, taken),)))
    assert (recording.q[0] == angles(taken)).all() and (recording.tau[0] == torques(taken)).all()
    assert recording.step == pytest.approx(1 / rate, rel=grain * rate / N)
    if np.ptp(np.diff(stamps)) > 1e-9:
        (note,) = recording.notes
        assert note.startswith("own.csv: stamps (steps of 0.0") and "are rounded; taken as" in note


@pytest.mark.parametrize("lost", [[50, 120, 121], range(9, N - 1, 20), range(2, N - 1, 3)])
def test_missing_samples_are_filled_in_and_others_stay(lost):
    """Single ones, one in 20, one in 3: what is regular is no rounding."""
    keep = np.delete(np.arange(N), lost)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        recording = resample(Log((run(STEP * keep),)))
    assert [x.category for x in caught] == [LogWarning] * (len(lost) > 0.01 * N)
    assert recording.q.shape == (1, N, 2) and recording.step == pytest.approx(STEP)
    assert (recording.q[0, keep] == angles(STEP * keep)).all()
    assert (recording.tau[0, keep] == torques(STEP * keep)).all()
    np.testing.assert_allclose(recording.q[0], angles(STEP * np.arange(N)), atol=1e-5)
    np.testing.assert_allclose(recording.tau[0], torques(STEP * np.arange(N)), atol=0.005)
    (note,) = recording.notes
    first = f"{len(lost)} missing samples interpolated, the first after line {lost[0] + 1}"
    assert note.startswith(f"own.csv: {first}")
    assert (recording.lines[0, keep] == 2 + np.arange(len(keep))).all()


def test_regular_losses_spoil_no_inertia():
    """One line in 20 is lost; read as rounded stamps, the inertia a comes out a fifth too small."""
    log, a, _, _ = swinging(0.01)
    (whole,) = log.runs
    keep = np.delete(np.arange(len(whole.t)), range(9, len(whole.t) - 1, 20))
    lossy = LoggedRun("lossy", whole.t[keep], whole.q[keep], whole.tau[keep], keep)
    inertia = {}
    for trust in (True, False):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", LogWarning)
            warnings.simplefilter("ignore", DoubtfulRecording)  # a wrong time looks like a weight
            recording = resample(Log((lossy,)), trust_stamps=trust)
            inertia[trust] = least_squares(by_modulation(recording, RIGID, width=0.3)).values[0]
    assert inertia[True] == pytest.approx(a, rel=5e-3)
    assert inertia[False] < 0.9 * a


@pytest.mark.parametrize("share", [0.05, 0.2, 0.45])
def test_uneven_stamps_are_interpolated(share):
    """A cubic spline's error is below 5/384 h^4 max|q''''|; a line's below h^2/8 max|tau''|."""
    stamps = jittered(share)
    recording = resample(Log((run(stamps),)))
    widest = np.diff(stamps).max()
    t = recording.t + (0 if recording.t[0] else stamps[0])
    off = np.abs(recording.q[0] - angles(t))[5:-5].max()
    assert off < 5 / 384 * widest**4 * 0.4 * 7**4 * 2
    assert off < np.abs(angles(stamps[: len(t)]) - angles(t)).max() / 100  # as they stood
    assert np.abs(recording.tau[0] - torques(t)).max() < widest**2 / 8 * 25
    assert recording.step == pytest.approx(STEP, rel=2e-3)
    assert "uneven stamps (steps of" in recording.notes[0] and len(recording.notes) == 1


def test_late_stamps_change_no_sample_and_those_in_bursts_have_the_mean_step():
    taken = STEP * np.arange(N)
    recording = resample(Log((run(jittered(0.4), taken),)), trust_stamps=False)
    assert (recording.q[0] == angles(taken)).all()
    assert recording.step == pytest.approx(STEP, rel=3e-3)
    assert "late notes of samples at even steps" in recording.notes[0]
    recording = resample(Log((run(taken + 0.45 * STEP * (np.arange(N) % 2)),)))
    assert recording.step == pytest.approx(STEP, rel=2e-3)
    np.testing.assert_allclose(recording.q[0], angles(recording.t), atol=1e-5)


def test_gaps_part_a_run():
    k = np.r_[:150, 160:300, 340:400]
    with pytest.warns(LogWarning, match=r"^own.csv: 20 % of the samples of the log were left out"):
        recording = resample(Log((run(STEP * k),)))
    assert recording.names == ("own.csv, part 1", "own.csv, part 2")
    assert (recording.q == angles(STEP * np.r_[:140, 160:300]).reshape(2, 140, 2)).all()
    parted, short, cut = recording.notes
    assert "2 gaps of more than 3 steps, the longest of 0.41 s before line 292" in parted
    assert short == "left out, as shorter than 140 samples: own.csv, part 3."
    assert cut == "cut into 2 runs of 140 samples, 1.4 s; 10 samples at their ends left out."
    with pytest.warns(LogWarning, match="% of the samples of the log were filled in"):
        assert resample(Log((run(STEP * k[:290]),)), longest_gap=11).q.shape == (1, 300, 2)


@pytest.mark.parametrize("lengths, kept", [
    ((400, 6), (1, 400)), ((6, 400, 6, 6), (1, 400)), ((400, 398, 399), (3, 398)),
    ((100, 60), (2, 60)), ((100, 200, 300, 400), (2, 300)),
])  # fmt: skip
def test_runs_of_unlike_lengths_keep_most_samples(lengths, kept):
    runs = tuple(run(STEP * np.arange(n), name=f"{n}.csv") for n in lengths)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        recording = resample(Log(runs))
    assert recording.q.shape == (*kept, 2)
    assert len(caught) == (1 - kept[0] * kept[1] / sum(lengths) > 0.01)
    notes = " ".join(recording.notes)
    assert all(f"{n}.csv" in notes for n in lengths if n < kept[1])
    ends = sum(n - kept[1] for n in lengths if n >= kept[1])
    assert f"{ends} samples at their ends left out" in notes or not ends


def test_seconds_cut_long_runs_into_several():
    runs = (run(STEP * np.arange(N)), run(STEP * np.arange(130), name="other.csv"))
    with pytest.warns(LogWarning, match="6 % of the samples of the log were left out"):
        recording = resample(Log(runs), seconds=1)
    assert recording.names == (*(f"own.csv, cut {k}" for k in (1, 2, 3, 4)), "other.csv")
    assert (recording.q[:4] == angles(STEP * np.arange(N)).reshape(4, 100, 2)).all()
    with pytest.raises(ValueError, match=r"^seconds must lie in \[0.03, 4\], got 5"):
        resample(Log(runs), seconds=5)


def test_a_lower_rate_comes_after_a_low_pass():
    """10 Hz pass, 120 Hz do not fold back to 20 Hz, nothing lags, and what rests stays."""
    t = np.arange(4000) / 1000
    slow, fast = np.sin(2 * np.pi * 10 * t), np.sin(2 * np.pi * 120 * t)
    q, tau = np.stack([slow, slow + fast], -1), np.stack([fast, slow], -1)
    recording = resample(Log((LoggedRun("own.csv", t, q, tau, np.arange(4000)),)), step=0.01)
    right = np.stack([slow, slow, 0 * slow, slow], -1)[::10]
    found = np.concatenate([recording.q[0], recording.tau[0]], -1)
    assert np.abs(found - right)[30:-30].max() < 0.015
    assert recording.step == pytest.approx(0.01) and recording.q.shape == (1, 400, 2)
    assert recording.notes[-1] == "own.csv: low-pass without a lag, up to 40 Hz."
    still = LoggedRun("still", t, np.ones((4000, 2)), 2 * np.ones((4000, 2)), np.arange(4000))
    still = resample(Log((still,)), step=0.01)
    np.testing.assert_allclose([still.q, still.tau / 2], 1.0, atol=1e-9)
    finer = resample(Log((run(STEP * np.arange(N)),)), step=0.004)
    np.testing.assert_allclose(finer.q[0], angles(finer.t), atol=2e-6)
    assert "finer than logged: nothing is gained" in finer.notes[0]


def test_clocks_that_differ_a_little_share_the_mean_step():
    runs = (run(STEP * np.arange(N)), run(1.0005 * STEP * np.arange(N), name="other.csv"))
    recording = resample(Log(runs))
    assert recording.step == pytest.approx(1.00025 * STEP, rel=1e-9)
    assert (recording.q[0] == angles(runs[0].t)).all()
    assert recording.notes == (
        "runs have steps of 0.01 to 0.010005 s; all are taken as 0.0100025 s.",
    )


def test_errors_say_what_to_do():
    log = Log((run(STEP * np.arange(N)), run(0.004 * np.arange(N), name="fast.csv")))
    for stamps, told in (
        (-STEP * np.arange(9), "own.csv, line 3: time must grow, but -0 s is followed by -0.01 s"),
        ([0, 0.01, 0.02, 0.02, 0.03], "own.csv, line 5: time must grow, .* skip_bad=True .* run="),
        ([0, 0.01], "own.csv: must have three samples or more, got 2"),
        ([0, 1, 3, 4, 6, 7], "own.csv: gaps leave no three samples in a row"),
    ):
        with pytest.raises(ValueError, match=told):
            resample(Log((run(stamps),)), longest_gap=1)
    with pytest.raises(
        ValueError, match=r"^own.csv: steps of 0.01 s, where 0.00\d s are usual; say"
    ):
        resample(log)
    with pytest.raises(ValueError, match=r"^log must hold one run or more, got none"):
        resample(Log(()))
    with pytest.raises(TypeError, match=r"^log must be of class Log, got LoggedRun"):
        resample(log.runs[0])
    for options in ({"step": 0}, {"step": 5}, {"longest_gap": 0}, {"seconds": -1}):
        with pytest.raises(ValueError, match=f"^{next(iter(options))} must"):
            resample(Log(log.runs[:1]), **options)


def test_windows_take_all_samples_that_have_a_whole_one(tmp_path):
    recording = record(CMU_DD_ARM_II, pd((150.0, 50.0), (1.0, 0.3)), [[40, 30], [20, 45], [25, 10]])
    write_csv(tmp_path / "arm.csv", recording)
    log, n = read_csv(tmp_path / "arm.csv"), recording.t.size
    for width in (3, 21, 103, 399):
        windows, torque = cases(log, width)
        centres = n - width + 1
        assert windows.shape == (3 * centres, 2, width)
        assert (windows[0, 0] == recording.q[0, :width, 0]).all()
        assert (torque[:centres] == recording.tau[0, width // 2 : n - width // 2]).all()
    with pytest.raises(ValueError, match=f"^width must not exceed the {n} samples of a run, got"):
        cases(log, n + 1 + n % 2)
    margins = log.for_windows(21)
    assert margins.motion == slice(10, n - 10) and margins.for_windows(5).motion == slice(2, n - 2)
    assert margins[:2].motion == margins.motion and margins[:2].names == log.names[:2]
    assert recording.for_windows(21) is recording  # a simulated one keeps its motion


def swinging(step):
    """A log of an arm that swings, whose torques are exact, and its inertias a, b, d."""
    t = np.arange(int(1.2 / step)) * step
    q = np.stack([0.6 * np.sin(9 * t) + 0.3 * np.sin(4 * t), 0.8 * np.cos(7 * t + 1)], -1)
    qd = np.stack([5.4 * np.cos(9 * t) + 1.2 * np.cos(4 * t), -5.6 * np.sin(7 * t + 1)], -1)
    qdd = np.stack([-48.6 * np.sin(9 * t) - 4.8 * np.sin(4 * t), -39.2 * np.cos(7 * t + 1)], -1)
    arm = CMU_DD_ARM_II
    log = Log((LoggedRun("own.csv", t, q, arm.inverse_dynamics(q, qd, qdd), t),))
    straight, bent = (arm.mass_matrix(np.array([0.0, x])) for x in (0.0, np.pi / 2))
    return log, bent[0, 0], (straight[0, 0] - bent[0, 0]) / 2, straight[1, 1]


def test_identification_of_a_log_needs_no_further_word():
    """A log that holds the torque at its stamp: equations of motion hold to the differences."""
    log, *inertias = swinging(0.002)
    log = resample(log)
    for equations in (by_modulation(log, RIGID, width=0.2), by_smoothing(log, 5, RIGID)):
        found = dict(zip(RIGID, least_squares(equations).values))
        np.testing.assert_allclose([found[name] for name in "abd"], inertias, rtol=2e-3)
    learnt = FilteredEquations(RIGID, 7, log.step, pull=1.0).fit(log)
    assert learnt.predict(log).shape == (1, 600 - 6, 2)
    assert learnt.parameters["d"] == pytest.approx(inertias[2], rel=0.02)
