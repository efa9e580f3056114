"""What a check of a recording found, drawn where it was found."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ddlib._check import integer
from ddlib.figures.style import COLOURS, JOINTS, TONES, Illustration, illustrate, legend_above
from ddlib.logs.findings import Check

_POINTS = 400  # of a curve: more are not seen, and weigh


def checked(check: Check, run: int | None = None) -> Illustration:
    """Angle, speed and torque of one run over time, with the samples of findings as dots.

    Parameters
    ----------
    check : Check
        From `ddlib.identification.check_recording`.
    run : int, optional
        Its number, counted from 0. Default: that of the worst finding that names samples.

    Raises
    ------
    ValueError
        If the check has no such run.
    """
    recording = check.recording
    marked = [finding for finding in check.findings if len(finding.rows)]
    if run is None:
        run = marked[0].run if marked else 0
    run = integer("run", run, 0, len(recording.q) - 1)
    marked = [finding for finding in marked if finding.run == run]
    t, q, tau = recording.t, recording.q[run], recording.tau[run]
    speed = np.gradient(q, recording.step, axis=0)
    series = {"angle, rad": q, "speed, rad/s": speed, "torque, N m": tau}
    every = max(1, len(t) // _POINTS)

    def draw(figure: Figure):
        axes = figure.subplots(2, 3, sharex=True)
        shown = {}
        for j, row in enumerate(axes):
            for axis, (label, values) in zip(row, series.items()):
                axis.plot(t[::every], values[::every, j], color=TONES[JOINTS[j]], lw=0.9)
                for k, kind in enumerate(dict.fromkeys(finding.kind for finding in marked)):
                    rows = [f.rows for f in marked if f.kind == kind and f.joint in (None, j)]
                    if not rows:
                        continue
                    at = np.concatenate(rows)
                    at = at[:: max(1, len(at) // 60)]
                    look = {"color": COLOURS[k % 6], "marker": "osv^D"[k % 5], "ms": 3.5}
                    (shown[kind],) = axis.plot(t[at], values[at, j], ls="", **look)
                axis.set_ylabel(label)
                axis.set_title(JOINTS[j])
                if j:
                    axis.set_xlabel("time, s")
        if shown:
            legend_above(figure, list(shown.values()), list(shown))

    kinds = ", ".join(dict.fromkeys(finding.kind for finding in marked)) or "nothing"
    alt = f"Angle, speed and torque of both joints over time, run {run + 1}. Marked: {kinds}."
    return illustrate(draw, alt, 7.0, 4.0)
