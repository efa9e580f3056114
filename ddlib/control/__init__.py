"""Controllers of the joints, and the linear analysis of their loops.

- ``controllers``: proportional, PD and PID control, feedforward, computed torque
- ``adaptive``, ``feedback_error``: controllers that learn while they control
- ``online``: the window network inside the controller, learning while the arm moves
- ``guarded``: a safety stop for runs that leave their limits
- ``windowed``: a model of windows as feedforward of a desired motion, or inside the loop
- ``linear``: loops as python-control systems: poles, `margins` of gain and phase
- ``delays``: poles of a sampled loop whose torque comes late
- ``velocity``: velocity from position readings, noise against lag
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    controllers=(
        "ComputedTorque ControlLaw Controller Feedforward PID as_controller pd proportional"
    ),
    feedback_error="FeedbackErrorLearning GenericTerms MotionMemory RigidBodyTerms",
    online="Abreast LastLayer LinearFilter OnlineDescent OnlineFeedforward OnlineNetwork TEACHERS",
    guarded="Guarded REASONS Stops",
    windowed=(
        "BETWEEN MeasuredWindows PlannedTorque WindowFeedforward past_slopes poles_inside "
        "reference_windows"
    ),
    linear="Margins closed_loop loop_gain margins opened_loop plant proportional_limit",
    delays="late_poles",
    velocity="EstimatedVelocity difference end_slope lag noise_gain stacked",
    **{
        "adaptive.regressor": "PARAMETERS mixed_regressor",
        "adaptive.running": "Watched",
        "adaptive.slotine_li": "SlotineLi",
        "adaptive.craig": "CraigHsuSastry",
        "adaptive.model_reference": "ModelReference",
    },
)
