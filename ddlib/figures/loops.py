"""Feedback loops: poles while the gain grows, beside gain and phase of the open loop."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations

import control
import numpy as np
from matplotlib.figure import Figure

from ddlib._check import instance, mapping, number, text
from ddlib.figures.style import FAINT, Illustration, illustrate, looks


def poles_and_bode(
    loops: Mapping[str, control.lti.LTI], alt: str, *, decay: float, sampled=None
) -> Illustration:
    """Root loci of loops by python-control, and their Bode plots beside these.

    Parameters
    ----------
    loops : mapping
        ``{name: open loop in continuous time}``. A dot is a closed loop's pole at a gain of 1.
    alt : str
        Alternative text.
    decay : float
        Poles that decay as fast settle in time, 1/s: their half plane is shaded.
    sampled : mapping, optional
        Open loops of the same names for the Bode plots, as the computer closes them.
    """
    mapping("loops", loops)
    text("alt", alt)
    number("decay", decay, 0.0, open_low=True)
    sampled = loops if sampled is None else sampled
    mapping("sampled", sampled)
    if set(sampled) != set(loops):
        raise ValueError(f"sampled must have the names of loops, got {', '.join(sampled)}")
    for kind, systems in (("loops", loops), ("sampled", sampled)):
        for name, system in systems.items():
            instance(f"{kind}[{name!r}]", system, control.lti.LTI)
    w = decay * np.geomspace(1 / 8, 25, 400)  # rad/s

    def draw(figure: Figure):
        places = [["loci", "gain"], ["loci", "phase"]]
        loci, *pair = figure.subplot_mosaic(places).values()
        for name, L in loops.items():
            look = looks(loops)[name].line
            paths = _paths(L, np.geomspace(1e-3, 4, 3000))
            loci.plot(paths.real, paths.imag, **look)
            now = control.feedback(L).poles()
            loci.plot(now.real, now.imag, "o", color=look["color"])
            look |= {"dB": True, "ax": np.c_[pair], "title": "", "legend_loc": False}
            control.bode_plot(sampled[name], w, **look)
        loci.axvspan(-3.2 * decay, -decay, color=FAINT, alpha=0.2, lw=0)
        loci.set(xlim=(-3.2 * decay, 0.4 * decay), ylim=(-2 * decay, 2 * decay))
        loci.set(xlabel="real part, 1/s", ylabel="imaginary part, rad/s")
        pair[0].set(ylabel="gain |L|, dB", xlim=(w[0], w[-1]), ylim=(-60, 60))
        pair[1].set(ylabel="phase, °", xlabel="frequency, rad/s", xlim=(w[0], w[-1]))
        pair[0].legend(pair[0].lines[:: len(pair[0].lines) // len(loops)], list(loops))

    return illustrate(draw, alt, 7.0, 2.9, narrow_height=7.0)


def _paths(L, gains: np.ndarray) -> np.ndarray:
    """Poles of the closed loop, a row for each gain and a column for each pole on its way.

    As `control.root_locus_map`, which takes twenty times as long: it asks for one gain at a time.
    """
    (numerator,), (denominator,) = (rows[0] for rows in control.tfdata(L))
    order = len(denominator) - 1
    sums = denominator + np.outer(gains, np.pad(numerator, (len(denominator) - len(numerator), 0)))
    companions = np.zeros((len(gains), order, order))
    companions[:, range(1, order), range(order - 1)] = 1
    companions[:, 0] = -sums[:, 1:] / sums[:, :1]
    poles = np.linalg.eigvals(companions).astype(complex)
    ways = np.array([*permutations(range(order))])
    steps = np.abs(poles[1:, ways] - poles[:-1, None]).sum(-1).argmin(1)
    way, found = np.arange(order), [poles[0]]
    for after, step in zip(poles[1:], steps):
        way = ways[step][way]
        found.append(after[way])
    return np.array(found)
