"""Controllers that learn, and networks inside the loop.

- ``adaptive``, ``feedback_error``: controllers that learn while they control
- ``online``: the window network inside the controller, learning while the arm moves
- ``guarded``: a safety stop for runs that leave their limits
- ``windowed``: a model of windows as feedforward of a desired motion, or inside the loop
- ``delays``: poles of a sampled loop whose torque comes late
"""
