"""The arm that the reader throws, and a window network that tells its torque from positions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.analysis import basis, shares
from ddlib.figures import COLOURS, DASHES, FAINT, INK, JOINTS, illustrate
from ddlib.learning import TorqueModel
from ddlib.paper import TEST_TRAJECTORY
from ddlib.setups import JOINT_DAMPING, predict
from ddlib.simulation import CONTROL_STEP, LOG_STEP
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS
from ddlib.widgets.base import PageWidget
from ddlib.widgets.engine._plain import gains, network, plant, weight_bytes
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.still import START, encoded

_HERE = Path(__file__).parent

_REST = 0.4  # s between two motions that are played: longer than half a window
_FORCE = 35.0  # N, most that the reader's pull can be: its torques are among those of the training
_SPRING = 150.0  # N/m, stiffness of the pull on the hand
_TOSS_RATE = 4.0  # rad/s^2, largest acceleration that the button gives the joints,
_TOSS_SECONDS = 0.4  # and for how long

_PARTS = "constant", "line", "parabola"

_HINT = (
    "By keyboard, move the focus to the hand and hold an arrow key. The network predicts the "
    "torque at the centre of each window."
)


class ThrownArm(PageWidget):
    """Throw the arm with damped joints; a window network tells the torque from positions alone.

    Everything is computed in the page by the live engine (``static/engine.js``), with a kernel
    and without.

    Parameters
    ----------
    model : TorqueModel
        One network, trained on the sampling period of the log.
    code : str
        What *Code* copies, with ``{motion}`` for the trajectory's place in Appendix I.
    """

    _esm = bundle(_HERE / "throw.js")
    _css = styles(_HERE / "throw.css")

    weights = t.Bytes(help="the network's weights as float32", read_only=True).tag(sync=True)

    def __init__(self, model: TorqueModel, *, code: str = ""):
        order = [TEST_TRAJECTORY, *(k for k in range(1, 7) if k != TEST_TRAJECTORY)]
        span = np.maximum(-model.outputs.low, model.outputs.high)
        still, alt = _still(model)
        spec = {
            "title": "Throw the arm: a network predicts its torque",
            "hint": _HINT,
            "code": code,
            "plant": plant(JOINT_DAMPING.arm, JOINT_DAMPING.effects),
            "gains": gains(JOINT_DAMPING.controller),
            "network": network(model),
            "step": CONTROL_STEP,
            "every": round(LOG_STEP / CONTROL_STEP),
            "motion": MOTION_SECONDS,
            "rest": _REST,
            "force": _FORCE,
            "spring": _SPRING,
            "toss": {"rate": _TOSS_RATE, "seconds": _TOSS_SECONDS},
            "torques": (0.5 * span).tolist(),
            "trajectories": [_trajectory(k) for k in order],
            "units": _units(model),
        }
        self._keep(spec=spec, weights=weight_bytes(model), still=still, still_alt=alt)
        super().__init__()


def _trajectory(k: int) -> dict:
    test = k == TEST_TRAJECTORY
    name = f"trajectory {k}, which the network {'never saw' if test else 'was trained on'}"
    return {"name": name, "number": k, "extents": np.deg2rad(APPENDIX_I[k - 1]).tolist()}


def _units(model: TorqueModel) -> list[dict]:
    """The hidden units whose weights from one joint's window lie closest to a line, a parabola.

    First the one in which both are large; it is the one that is shown.
    """
    parts = shares(model.weights.hidden_weights)
    line, parabola = parts[..., 1], parts[..., 2]
    wanted = {"both": line * parabola, "a line": line, "a parabola": parabola}
    units = []
    for kind, share in wanted.items():
        unit, joint = np.unravel_index(share.argmax(), share.shape)
        label = "A row with both" if kind == "both" else f"Most of {kind}"
        units.append({"label": label, "unit": int(unit), "joint": int(joint)})
    return units


def _still(model: TorqueModel) -> tuple[str, str]:
    """A motion with true torques and the network's, a row folded, and what the picture shows."""
    recording = JOINT_DAMPING.record(APPENDIX_I[[TEST_TRAJECTORY - 1]])[0]
    moving = recording.motion
    time, predicted = recording.t[moving], predict(model, recording)
    unit = _units(model)[0]
    row = model.weights.hidden_weights[unit["unit"], unit["joint"]]
    at, along = np.arange(len(row)) - len(row) // 2, basis(len(row))[:3]
    parts = along * (along @ row)[:, None]
    part = [f"{100 * share:.0f} %" for share in shares(row)]
    most = 1.1 * np.abs(row).max()
    hand = JOINT_DAMPING.arm.forward_kinematics(recording.q_true[moving])

    def motion(arm, angles, *torques):
        arm.plot(*hand[:, 1].T, color=FAINT, lw=1)
        for k, alpha in ((0, 0.3), (45, 0.55), (len(hand) // 2, 1.0)):
            x, y = np.vstack([[0, 0], hand[k]]).T
            arm.plot(x, y, "o-", color=COLOURS[0], alpha=alpha, lw=3)
        arm.set(title="The arm", aspect="equal")
        arm.axis("off")
        for j, (joint, axis) in enumerate(zip(JOINTS, torques)):
            angles.plot(time, np.rad2deg(recording.q[moving, j]), DASHES[j], label=joint)
            axis.plot(time, recording.tau_true[moving, j], color=INK, label="true")
            axis.plot(time, predicted[:, j], "--", color=COLOURS[1], label="network")
            axis.set(title=f"{joint.title()} torque, N m", xlabel="time, s")
        angles.set(title="Positions, °", xlabel="time, s")
        for axis in (angles, *torques):
            axis.legend()

    def folded(whole, *axes):
        names = (f"{kind} {share}" for kind, share in zip(_PARTS, part))
        titles = ("one row of weights", *(f"{'+' if k else '='} {n}" for k, n in enumerate(names)))
        for axis, title, values, k in zip((whole, *axes), titles, (row, *parts), (0, 3, 1, 2)):
            axis.vlines(at, 0, values, color=COLOURS[k])
            axis.plot(at, values, "o", ms=4, color=COLOURS[k])
            axis.set(title=title, xlabel="sample", ylim=(-most, most))

    def draw(figure):
        above, below = figure.subplots(2, 4)
        motion(*above)
        folded(*below)

    joint = JOINTS[unit["joint"]]
    alt = (
        f"The arm along trajectory {TEST_TRAJECTORY}, its joint angles over three seconds and, for "
        "shoulder and elbow, the true torque and what a network predicts from windows of "
        f"these angles. Below, the weights of one hidden unit for the {joint}, and their three "
        f"parts: a constant, a line with {part[1]} and a parabola with {part[2]} of their energy."
    )
    return START + encoded(illustrate(draw, alt, 11.0, 5.0).svg), alt
