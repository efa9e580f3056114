"""Controllers that learn while they control: the adaptive ones that section 1.1 cites.

`SlotineLi` and `CraigHsuSastry` adapt base parameters and friction, in which the torque is linear.
The first needs position and velocity only, and a function of its errors never rises
(`SlotineLi.lyapunov`); the second needs the acceleration, too, and an estimated mass matrix that
can be inverted. `ModelReference` knows nothing of arms: it adapts the gains of each joint.

A law that is started keeps its estimates: ``law.estimates`` after a run, ``law.estimate`` the
last. `Watched` keeps the law of a controller that somebody else starts. Gains, rates and
estimates may have leading axes, of runs.

- ``regressor``: the terms of the torque and what can be adapted
- ``slotine_li``, ``craig``, ``model_reference``: a controller each
- ``running``: a law that runs and remembers
"""
