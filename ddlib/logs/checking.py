"""Is a recording fit to be fitted? A doctor's page of a log, before anything is learnt from it."""

from __future__ import annotations

import warnings

import numpy as np

from ddlib.logs._motions import motions
from ddlib.logs._readings import SPIKE, readings
from ddlib.logs._stamps import stamps, units
from ddlib.logs._torques import at_work, commands
from ddlib.logs.findings import SEVERITIES, Check, Finding, in_runs, place
from ddlib.logs.log import Log, LoggedRecording
from ddlib.simulation import Recording


class DoubtfulRecording(UserWarning):
    """A recording shows something that makes results wrong."""


def check_recording(recording: Recording | Log) -> Check:
    """What a recording shows before anything is fitted to it, the worst first.

    Checked are the times (order, gaps, rounding, jitter), units, wraps, spikes, drop-outs and
    values that are held, saturation, joints that rest or have no torque, torques that look like a
    command, and by the equations of motion the signs, a lag, how the elbow's angle is counted,
    gravity, and which parameters the motion tells.

    Parameters
    ----------
    recording : Recording, LoggedRecording or Log
        Arrays of shape (..., time, 2), or runs with uneven times.

    Returns
    -------
    Check
        Its ``findings``, ``wrong`` and ``of(kind)``. A check that found nothing wrong does not
        say that nothing is.

    Raises
    ------
    TypeError
        If it is none of these.
    ValueError
        If the arrays do not have two joints.
    """
    runs = in_runs(recording)
    findings = []
    for k, run in enumerate(runs):
        for look in (stamps, units, readings, at_work):
            findings += look(k, run)
    findings += commands(runs)
    findings += motions(runs)
    order = {severity: place for place, severity in enumerate(SEVERITIES)}
    findings.sort(key=lambda f: order[f.severity])
    return Check(tuple(findings), runs)


def warn_of(recording: Recording) -> None:
    """Warn in one line of what makes every fit to a recording wrong; silent if nothing does.

    Only what a look at the numbers shows: time, units, wraps, spikes, drop-outs, no torque at all.
    `check_recording` looks at more, and takes longer than a fit.

    Parameters
    ----------
    recording : Recording
        Arrays (..., time, 2). Nothing is said of repetitions of simulated ones.

    Warns
    -----
    DoubtfulRecording
        With the worst findings and their places.
    """
    if not _suspect(recording):
        return
    wrong: list[Finding] = []
    for k, run in enumerate(in_runs(recording)):
        for look in (stamps, units, readings, at_work):
            wrong += [finding for finding in look(k, run) if finding.severity == "wrong"]
    if not wrong:
        return
    places = {}
    for finding in wrong:
        places.setdefault(finding.kind, []).append(finding)
    kinds = [f"{kind} ({place(of_kind[0], [f.where[0] for f in of_kind])})" for kind, of_kind in
            places.items()]  # fmt: skip
    warnings.warn(
        f"the recording shows what makes a fit wrong: {'; '.join(kinds[:3])}"
        f"{f' and {len(kinds) - 3} kinds more' if len(kinds) > 3 else ''}. "
        "check_recording(recording) says where, and what to do.",
        DoubtfulRecording,
        stacklevel=4,
    )


def warn_of_log(recording: Recording) -> None:
    """`warn_of` a recording that was made from a log; a simulated one is what it is."""
    if isinstance(recording, LoggedRecording):
        warn_of(recording)


def _suspect(recording: Recording) -> bool:
    """Whether a recording is worth a closer look: few operations on whole arrays.

    Each asks for less than the finding it stands for; what looks alike in a good recording (the
    begin of a motion) only costs the closer look.
    """
    q, tau = np.asarray(recording.q), np.asarray(recording.tau)
    step = (recording.t[-1] - recording.t[0]) / (len(recording.t) - 1)
    moves = np.diff(q, axis=-2)
    fastest = max(moves.max(), -moves.min())
    ranges, work = np.ptp(q, axis=-2), np.ptp(tau, axis=-2)
    if not np.isfinite(fastest + work.sum()) or not step > 0:
        return True
    if fastest > np.pi or fastest > 20 * step or fastest < 0.01 * step or ranges.max() < 1e-3:
        return True
    if not work.any(-1).all():
        return True
    large = np.abs(moves) > 0.3 * fastest
    still = moves == 0
    if (still[..., :-2, :] & still[..., 1:-1, :] & large[..., 2:, :]).any():
        return True
    there_and_back = large[..., :-2, :] & (moves[..., :-2, :] * moves[..., 2:, :] < 0)
    if (there_and_back & still[..., 1:-1, :] & large[..., 2:, :]).any():
        return True
    # one wrong sample stands out of all fourth differences, and has their shape
    fourth = np.diff(moves, 3, axis=-2)
    high = np.abs(fourth) > 8 * np.sqrt(np.vdot(fourth, fourth) / fourth.size)
    if not high.any():
        return False
    *place, row, joint = np.nonzero(high[..., 2:-2, :])
    near = fourth[*(x[:, None] for x in place), row[:, None] + np.arange(5), joint[:, None]]
    alike = (near @ SPIKE) ** 2 / (SPIKE @ SPIKE)
    return bool((alike > 0.9 * (near**2).sum(-1)).any())
