"""A law that runs: called once a control period, it remembers its estimates."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ddlib._check import number
from ddlib.control.controllers import ControlLaw, Controller, as_controller
from ddlib.trajectories import Trajectory


class _RunningLaw:
    """A running adaptive law.

    Its controller's ``advance(law, estimate, wanted, q, qd)`` gives the torque and the next
    estimate; `memory` is the controller's to use.
    """

    def __init__(self, controller, reference: Trajectory, step: float):
        self.step = number("step", step, 0.0, open_low=True)
        self.controller, self.reference, self.memory = controller, reference, None
        self._kept = [np.asarray(controller.estimate, float)]

    def __call__(self, k, q, qd):
        wanted = Trajectory(*(x[..., k, :] for x in self.reference))
        torque, after = self.controller.advance(self, self._kept[-1], wanted, q, qd)
        self._kept.append(after)
        return torque

    @property
    def estimates(self) -> np.ndarray:
        """Estimates before each call and after the last, shape (..., calls + 1, parameters)."""
        return np.stack(np.broadcast_arrays(*self._kept), -2)

    @property
    def estimate(self) -> np.ndarray:
        """Estimates after the last call, shape (..., parameters)."""
        return self._kept[-1]


@dataclass(frozen=True)
class Watched:
    """A controller whose last law can be asked after the run: ``watched.law``."""

    controller: Controller
    _laws: list = field(default_factory=list, compare=False, repr=False)

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law of the controller inside, kept."""
        law = as_controller(self.controller).start(reference, step)
        self._laws[:] = [law]
        return law

    @property
    def law(self) -> ControlLaw:
        """The law of the last run; a ValueError if there was none."""
        if not self._laws:
            raise ValueError("controller must have been started before its law can be asked")
        return self._laws[0]
