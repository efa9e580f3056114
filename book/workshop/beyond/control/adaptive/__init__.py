"""Controllers that adapt while they control: the ones that section 1.1 cites.

`SlotineLi` and `CraigHsuSastry` adapt base parameters and friction, in which the torque is linear.
The first needs position and velocity only, and a function of its errors never rises
(`SlotineLi.lyapunov`); the second needs the acceleration, too, and an estimated mass matrix that
can be inverted. `ModelReference` knows nothing of arms: it adapts the gains of each joint.

A law that is started keeps its estimates: ``law.estimates`` after a run, ``law.estimate`` the
last. Gains, rates and estimates may have leading axes, of runs.
"""
