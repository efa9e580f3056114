"""Figures of the chapter *What feedback does*, and what its claims measure."""

from __future__ import annotations

from collections.abc import Mapping

import control
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ddlib._check import finite_array
from ddlib.effects import Effects
from ddlib.figures.style import COLOURS, FAINT, INK, Illustration, illustrate
from ddlib.simulation import Load
from ddlib.tables import significant
from ddlib.trajectories import APPENDIX_I
from workshop.chapters.feedforward import _errors, _geared, _rms
from workshop.report.evidence.verdicts import Measured


def root_loci(loops: Mapping[str, control.TransferFunction], gains) -> Illustration:
    """Poles of closed loops while the whole loop gain is multiplied by a factor.

    Crosses are the open loop's poles, rings its zeros, dots the poles at factor 1.
    """
    gains = finite_array("gains", gains)
    if gains.ndim != 1 or gains.size < 2 or gains[0] <= 0 or (np.diff(gains) <= 0).any():
        raise ValueError(f"gains must be positive and increase, got shape {gains.shape}")
    if not loops:
        raise ValueError("loops must hold one loop or more, got none")
    poles = {title: control.feedback(loop, 1).poles() for title, loop in loops.items()}

    def draw(figure: Figure):
        axes = figure.subplots(1, len(loops), squeeze=False)[0]
        for axis, (title, loop) in zip(axes, loops.items()):
            branches = control.root_locus_map(loop, gains=gains).loci
            axis.axvline(0, color=FAINT, lw=1)
            for k, branch in enumerate(branches.T):
                axis.plot(branch.real, branch.imag, color=COLOURS[k % len(COLOURS)])
            axis.plot(loop.poles().real, loop.poles().imag, "x", color=INK, ms=7, mew=1.5)
            axis.plot(loop.zeros().real, loop.zeros().imag, "o", color=INK, ms=7, mfc="none")
            axis.plot(poles[title].real, poles[title].imag, "o", color=INK, ms=5)
            axis.set(title=title, xlabel="real part, 1/s")
            axis.margins(0.08)
        axes[0].set_ylabel("imaginary part, rad/s")

    where = "; ".join(
        f"{title}: " + ", ".join(_words(p) for p in sorted(x, key=abs) if p.imag >= 0)
        for title, x in poles.items()
    )
    return illustrate(draw, f"Root loci. Poles at factor 1: {where}.", 7.0, 2.9)


def _words(pole) -> str:
    imaginary = f" ± {pole.imag:.2g}i" if pole.imag > 1e-9 else ""
    return f"{pole.real + 0.0:.2g}{imaginary}".replace("-", "−")


def nyquist(loops: Mapping[str, control.TransferFunction], frequencies) -> Illustration:
    """Open loops in the complex plane, and how near each comes to the point -1.

    The circle around -1 has the radius of the smallest distance, which is one over the largest
    sensitivity ``max |1 / (1 + L)|``; a dot marks where the loop touches it.
    """
    frequencies = finite_array("frequencies", frequencies)
    if frequencies.ndim != 1 or frequencies.size < 2 or frequencies[0] <= 0:
        raise ValueError(f"frequencies must be positive, got shape {frequencies.shape}")
    if (np.diff(frequencies) <= 0).any():
        raise ValueError("frequencies must increase")
    if not loops:
        raise ValueError("loops must hold one loop or more, got none")
    answers = {title: np.ravel(loop(1j * frequencies)) for title, loop in loops.items()}
    nearest = {title: _nearest(loops[title], L, frequencies) for title, L in answers.items()}
    largest = {title: 1 / abs(1 + L) for title, (_, L) in nearest.items()}

    def draw(figure: Figure):
        panels = figure.subplots(1, len(loops), squeeze=False, sharex=True, sharey=True)[0]
        for axis, (title, L) in zip(panels, answers.items()):
            axis.axhline(0, color=FAINT, lw=1)
            axis.axvline(0, color=FAINT, lw=1)
            axis.add_patch(Circle((0, 0), 1, fill=False, ec=FAINT, ls=":"))
            axis.add_patch(Circle((-1, 0), 1 / largest[title], fill=False, ec=COLOURS[1]))
            axis.plot(L.real, L.imag, color=COLOURS[0])
            axis.plot(-1, 0, "+", color=INK, ms=8, mew=1.5)
            _, near = nearest[title]
            axis.plot(near.real, near.imag, "o", color=COLOURS[1], ms=5)
            axis.set(title=f"{title}, $M_s$ = {largest[title]:.3g}", xlabel="real part of L")
            axis.set_aspect("equal")
            axis.set(xlim=(-3, 1.2), ylim=(-2.4, 1.8))
        panels[0].set_ylabel("imaginary part of L")

    told = "; ".join(
        f"{title}: {largest[title]:.3g} at {at:.2g} rad/s" for title, (at, _) in nearest.items()
    )
    return illustrate(draw, f"Nyquist plots. Largest sensitivity: {told}.", 7.0, 2.9)


def _nearest(loop, answers, frequencies) -> tuple[float, complex]:
    """Where a loop comes nearest to -1, rad/s, and its value there."""
    k = int(np.abs(1 + answers).argmin())
    low, high = frequencies[[max(k - 1, 0), min(k + 1, frequencies.size - 1)]]
    fine = np.linspace(low, high, 1001)
    values = np.ravel(loop(1j * fine))
    best = int(np.abs(1 + values).argmin())
    return float(fine[best]), complex(values[best])


# --- what the claims of the chapter measure


def disturbances(load: float = 5.0) -> Measured:
    """How many times smaller feedback makes the error under a constant load."""
    effects = Effects(actuator=(Load((load, 0.0)),))
    with_, without = _rms(_errors([1, 1], [1, 0], effects))
    text = f"{load:g} N m on the shoulder: {significant(with_, 2)}° for "
    text += f"{significant(without, 2)}° without"
    return Measured(float(without / with_), text)


def backdriven(gear: float = 100.0) -> Measured:
    """How far the moving shoulder throws the elbow off, without gears over behind gears."""
    direct, geared = np.abs(_geared(gear, False, APPENDIX_I[3])[..., 1]).max(1)
    text = f"the shoulder throws a resting elbow off by {direct:.1f}°, "
    text += f"behind gears of {gear:g} to 1 by {geared:.2f}°"
    return Measured(float(direct / geared), text)
