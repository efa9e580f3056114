"""Feedback loops: poles while the gain grows, beside gain and phase of the open loop."""

from __future__ import annotations

from collections.abc import Mapping

import control
import numpy as np
from matplotlib.figure import Figure

from ddlib._check import instance, mapping, number, text
from ddlib.figures.style import FAINT, Illustration, illustrate, looks


def poles_and_bode(
    loops: Mapping[str, control.lti.LTI], alt: str, *, decay: float, sampled=None
) -> Illustration:
    """Root loci of loops by python-control, and their Bode plots beside these, margins thick.

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
    gains = np.geomspace(1e-3, 4, 1000)
    paths = {name: control.root_locus_map(L, gains=gains).loci for name, L in loops.items()}

    def draw(figure: Figure):
        places = [["loci", "gain"], ["loci", "phase"]]
        loci, *pair = figure.subplot_mosaic(places).values()
        for name, L in loops.items():
            look = looks(loops)[name].line
            loci.plot(paths[name].real, paths[name].imag, **look)
            now = control.feedback(L).poles()
            loci.plot(now.real, now.imag, "o", color=look["color"])
            look |= {"dB": True, "ax": np.c_[pair], "title": "", "legend_loc": False}
            control.bode_plot(sampled[name], w, **look)
            seen = control.frequency_response(sampled[name], w)
            at = np.flatnonzero(np.diff(seen.magnitude > 1))  # where the gain crosses 0 dB
            margin = np.angle(-np.exp(1j * seen.phase[at]), deg=True)
            pair[1].vlines(w[at], -180, margin - 180, color=look["color"], lw=4)
        loci.axvspan(-3.2 * decay, -decay, color=FAINT, alpha=0.2, lw=0)
        loci.set(xlim=(-3.2 * decay, 0.4 * decay), ylim=(-2 * decay, 2 * decay))
        loci.set(xlabel="real part, 1/s", ylabel="imaginary part, rad/s")
        pair[1].axhline(-180, color=FAINT, lw=0.8)
        pair[0].set(ylabel="gain |L|, dB", xlim=(w[0], w[-1]), ylim=(-60, 60))
        pair[1].set(ylabel="phase, °", xlabel="frequency, rad/s", xlim=(w[0], w[-1]))
        pair[0].legend(pair[0].lines[:: len(pair[0].lines) // len(loops)], list(loops))

    return illustrate(draw, alt, 7.0, 2.9, narrow_height=7.0)
