"""Is a recording fit to be fitted? A doctor's page of a log, before anything is learnt from it."""

from __future__ import annotations

import warnings

import numpy as np

from ddlib.logs._motions import motions
from ddlib.logs._readings import readings
from ddlib.logs._stamps import stamps, units
from ddlib.logs._torques import at_work, commands
from ddlib.logs.findings import SEVERITIES, Check, Finding, in_runs
from ddlib.logs.log import Log
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
