"""The rigid body: arms, their equations of motion, and what computing them costs.

- ``arm``: `Arm` of two links, made of `Link`, with a load; the book's arm and two others
- ``kinematics``: where the hand is and how to get it there; circles of the hand
- ``serial``: arms in space of any number of joints; the PUMA 560
- ``joints``: the arm of seven joints, and tools for any number: mass matrix, hand, regressor
- ``derivation``: the equations of motion, derived by sympy
- ``formulations``: Lagrange-Euler, its recursion and Newton-Euler in plain arithmetic
- ``counting``, ``costs``: multiplications and additions counted by running a formulation
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
