"""A two-link arm, its control, and networks that learn its dynamics: the picture of the house.

Packages stand in the order in which data flows. Each may import those above it, none below it::

    _check            argument checks: errors name the argument, its value and its range
    _names            how a package hands on the names of its modules
    paper             the paper's printed numbers
    metrics           the paper's error measure, RMSS
    tables            tables, numbers as text, and `quote` for the prose of a page
    trajectories      reference motions: the pick-and-place family of Appendix I
    others            data that others made: a simulated arm that writes, a real arm
    dynamics          the rigid body: arms, equations of motion, what computing them costs
    effects           what the rigid body leaves out: friction, motors, encoders
    control           controllers, and the linear analysis of their loops
    simulation        arm, controller and sensors together: recordings
    identification    parameters of an arm from recordings
    learning          windows, networks and their training
    analysis          what weights do and what data allow: filters, hidden units, noise
    rivals            what else learns torques: tables, CMAC, Gaussian processes, ...
    figures           the house style, and one function for each kind of figure
    experiments       the paper's experiments: set-ups, studies, committed results
    evidence          claims, what measures them, verdicts, the ledger
    widgets           interactive figures, with a kernel and without

Inside a package modules import each other by their full name; from another package, import what
it hands on: ``from ddlib.dynamics import Arm``. A package's docstring says what lies in which of
its modules. The test that holds this order is ``tests/house/test_imports.py``.
"""
