"""The arm that the reader throws, and a window network that tells its torque from positions."""

from __future__ import annotations

import numpy as np
import traitlets as t

from ddlib.analysis import shares
from ddlib.figures import JOINTS
from ddlib.learning import TorqueModel
from ddlib.paper import TEST_TRAJECTORY
from ddlib.setups import JOINT_DAMPING, Setup, predict
from ddlib.simulation import CONTROL_STEP, LOG_STEP
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS
from ddlib.widgets._baking.still import still_picture
from ddlib.widgets.base import STYLE, _PageWidget, module
from ddlib.widgets.engine._plain import ENGINE, _weight_bytes, gains, lean, network, plant
from ddlib.widgets.parts.panels import Panel

_REST = 0.4  # s between two motions that are played: longer than half a window
_FORCE = 35.0  # N, most that the reader's pull can be: its torques are among those of the training
_SPRING = 150.0  # N/m, stiffness of the pull on the hand
_TOSS_RATE = 4.0  # rad/s^2, largest acceleration that the button gives the joints,
_TOSS_SECONDS = 0.4  # and for how long

_HINT = (
    "Grab the hand and throw it, or focus it and hold an arrow key. Friction slows the arm; under "
    "Play a controller drives it along the paper's trajectories. The network never sees the "
    "torque: from each window of positions it tells the torque at the window's centre."
)


class ThrownArm(_PageWidget):
    """Throw a simulated arm; a window network tells the torque from positions alone.

    Everything is computed in the page by the live engine (``static/engine.js``), with a kernel
    and without.

    Parameters
    ----------
    model : TorqueModel
        One network, trained on the sampling period of the log.
    setup : Setup
        Arm, effects and controller; the engine must have the effects, and the controller must be
        a `PID`.
    code : str
        What *Code* copies, with ``{motion}`` for the trajectory's place in Appendix I.
    """

    _esm = lean(
        module(
            "elements.js", *ENGINE, "world.js", "canvas.js", "running.js", "inside.js", "throw.js"
        )
    )
    _css = module(*STYLE, "throw.css")

    weights = t.Bytes(help="the network's weights as float32", read_only=True).tag(sync=True)

    def __init__(self, model: TorqueModel, setup: Setup = JOINT_DAMPING, *, code: str = ""):
        layout = network(model)
        if model.step is not None and abs(model.step / LOG_STEP - 1) > 1e-6:
            raise ValueError(
                f"model must have the log's sampling period of {LOG_STEP:g} s, got {model.step:g} s"
            )
        order = [TEST_TRAJECTORY, *(k for k in range(1, 7) if k != TEST_TRAJECTORY)]
        span = np.maximum(-model.outputs.low, model.outputs.high)
        still, alt = _still(model, setup)
        spec = {
            "title": "Throw the arm: a network tells its torque",
            "hint": _HINT,
            "code": code,
            "plant": plant(setup.arm, setup.effects),
            "gains": gains(setup.controller),
            "network": layout,
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
        self._keep(spec=spec, weights=_weight_bytes(model), still=still, still_alt=alt)
        super().__init__()


def _trajectory(k: int) -> dict:
    test = k == TEST_TRAJECTORY
    name = f"trajectory {k}, which the network {'never saw' if test else 'was trained on'}"
    return {"name": name, "number": k, "extents": np.deg2rad(APPENDIX_I[k - 1]).tolist()}


def _units(model: TorqueModel) -> list[dict]:
    """The hidden units whose weights from one joint's window lie closest to a line, a parabola."""
    parts = shares(model.weights.hidden_weights)
    units = []
    for kind, degree in (("line", 1), ("parabola", 2)):
        unit, joint = np.unravel_index(parts[..., degree].argmax(), parts.shape[:2])
        label = f"The unit closest to a {kind}"
        units.append({"label": label, "unit": int(unit), "joint": int(joint)})
    return units


def _still(model: TorqueModel, setup: Setup) -> tuple[str, str]:
    """A motion with true torques and the network's, and what the picture shows."""
    recording = setup.record(APPENDIX_I[[TEST_TRAJECTORY - 1]])[0]
    moving = recording.motion
    time, told = recording.t[moving], predict(model, recording)
    curves = {
        f"{joint} angle": np.rad2deg(recording.q[moving, j]) for j, joint in enumerate(JOINTS)
    }
    for j, joint in enumerate(JOINTS):
        curves[f"{joint} true"] = recording.tau_true[moving, j]
        curves[f"{joint} network"] = told[:, j]
    angles = {f"{joint} angle": joint for joint in JOINTS}
    panels = [Panel("Positions that the network sees, °", angles, "time, s", time)]
    for joint in JOINTS:
        lines = {f"{joint} true": "true", f"{joint} network": "network"}
        panels.append(Panel(f"{joint.title()} torque, N m", lines, "time, s", time))
    alt = (
        f"The arm's joint angles along trajectory {TEST_TRAJECTORY} over three seconds; beside "
        "them, for shoulder and elbow, the true torque and the torque that a network tells from "
        "windows of these angles."
    )
    return still_picture(curves, panels, {}, None, alt), alt
