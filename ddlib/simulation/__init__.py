"""Arm, controller and sensors run together, each at its own rate: recordings.

- ``plant``: the arm with its frictions, motors and shafts, integrated under held torques
- ``simulate``: `record` (a pick-and-place motion), `follow` (any reference), `free_motion`
- ``recording``: `Recording`, what the log holds; its torque beyond the rigid body's
- ``loops``: responses of a loop, predicted and simulated; Figure 2-1; scores of a recording
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
