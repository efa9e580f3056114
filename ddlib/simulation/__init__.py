"""Arm, controller and sensors run together, each at its own rate: recordings.

- ``plant``: the arm with its frictions, motors and shafts, integrated under held torques
- ``simulate``: `record` (a pick-and-place motion), `follow` (any reference), `free_motion`
- ``recording``: `Recording`, what the log holds; its torque beyond the rigid body's
- ``loops``: responses of a loop, predicted and simulated; Figure 2-1; scores of a recording
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    recording="Recording residual_torque rms",
    simulate="CONTROL_STEP LOG_STEP REST follow free_motion record",
    loops=(
        "Load SecondOrderModel feedforward_system predicted_response run_system score "
        "simulated_response smooth_pick_and_place"
    ),
)
