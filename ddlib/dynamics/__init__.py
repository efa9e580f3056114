"""The rigid body: arms, their equations of motion, and what computing them costs.

- ``arm``: `Arm` of two links, made of `Link`, with a load; the book's arm and two others
- ``kinematics``: where the hand is and how to get it there; circles of the hand
- ``serial``: arms in space of any number of joints; the PUMA 560
- ``joints``: the arm of seven joints, and tools for any number: mass matrix, hand, regressor
- ``derivation``: the equations of motion, derived by sympy
- ``formulations``: Lagrange-Euler, its recursion and Newton-Euler in plain arithmetic
- ``counting``, ``costs``: multiplications and additions counted by running a formulation
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    arm="Arm CMU_DD_ARM_II IMI_ARM Link REYES_KELLY_ARM STANDARD_GRAVITY with_load",
    kinematics=(
        "ELBOWS Unreachable around end_point_error follow_hand inverse_kinematics jacobian reach"
    ),
    serial="PUMA_560 PUMA_560_GEARS PUMA_560_ROTORS SerialArm SpatialLink",
    joints="DD_ARM_II_IN_SPACE hand inertial_parameters locked mass_matrix regressor",
    formulations="lagrange_euler newton_euler recursive_lagrange",
    derivation="derive",
    counting="Operations Tape",
    costs="count table",
)
