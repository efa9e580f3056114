"""Figures of control engineering: where the poles of a loop go."""

from __future__ import annotations

from collections.abc import Mapping

import control
import numpy as np
from matplotlib.figure import Figure

from ddlib._check import finite_array
from ddlib.figures.style import COLOURS, FAINT, INK, Illustration, illustrate


def root_loci(loops: Mapping[str, control.TransferFunction], gains) -> Illustration:
    """Poles of closed loops while the whole loop gain is multiplied by a factor.

    Crosses are the open loop's poles, rings its zeros, dots the poles at factor 1.

    Parameters
    ----------
    loops : mapping
        ``{title: open loop}``, a panel each.
    gains : array_like, shape (n,)
        Factors, positive and increasing; python-control's `root_locus_map` adds more where
        the poles move fast.
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
