"""Smoothers beside learnt filters: exact motions give exact parameters, and one rule tunes all."""

from dataclasses import replace

import numpy as np
import pytest

from beyond.studies.checks import smoothers
from ddlib.effects import IDEAL
from ddlib.identification import RIGID
from ddlib.setups import STATE_FEEDBACK, split


@pytest.fixture(scope="module")
def ideal():
    """Six sums of sines, and the torques that the arm needs for them."""
    recording, rng = STATE_FEEDBACK.record(effects=IDEAL), np.random.default_rng(0)
    phase = rng.uniform(0, 2 * np.pi, (2, 6, 1, 2))
    q, qd, qdd = 0, 0, 0
    for speed, angle in zip((2.0, 5.0), phase):
        wave = speed * recording.t[:, None] + angle
        q, qd = q + 0.3 * np.sin(wave), qd + 0.3 * speed * np.cos(wave)
        qdd = qdd - 0.3 * speed**2 * np.sin(wave)
    torque = STATE_FEEDBACK.arm.inverse_dynamics(q, qd, qdd)
    return split(replace(recording, q=q, tau=torque, tau_true=torque))


@pytest.mark.parametrize("way", [("Butterworth filter", (13.0,)), ("Kalman smoother", (2.0,))])
def test_a_clean_recording_gives_the_inertias_and_the_torques(ideal, way):
    training, six = ideal
    name, setting = way
    kept = smoothers._WAYS[name][setting](RIGID, training)
    arm = STATE_FEEDBACK.arm
    np.testing.assert_allclose(kept.values, [arm.a, arm.b, arm.d], rtol=0.02)
    assert kept.predict(six).shape == six.tau[six.motion].shape
    assert smoothers._wrong(kept, six) < 0.02


def test_a_late_sensor_logs_what_was_applied_two_samples_before():
    setup = smoothers._ARMS["late sensor"][0]
    quiet = [e for e in setup.effects.torque_sensor if not hasattr(e, "std")]
    recording = setup.record(effects=replace(setup.effects, torque_sensor=tuple(quiet)))
    late = smoothers._SENSOR_LATE
    np.testing.assert_allclose(recording.tau[:, late:], recording.tau_true[:, :-late])


def test_a_smoother_with_a_delay_gives_the_torque_that_was_applied(ideal):
    """Torques logged two samples late: the delay that is told decides what comes out."""

    def logged_late(recording):
        return replace(recording, tau=np.roll(recording.tau, smoothers._SENSOR_LATE, axis=-2))

    training, six = map(logged_late, ideal)
    (ways,) = smoothers._MORE["late sensor"].values()
    kept = {delay: ways[13.0, delay](RIGID, training) for delay in (0, smoothers._SENSOR_LATE)}
    for logged in (True, False):
        right, wrong = (
            smoothers._wrong(kept[d], six, logged=logged) for d in (smoothers._SENSOR_LATE, 0)
        )
        assert right < 1e-6 and wrong > 0.01
    arm = STATE_FEEDBACK.arm
    np.testing.assert_allclose(
        kept[smoothers._SENSOR_LATE].values, [arm.a, arm.b, arm.d], rtol=1e-4
    )
