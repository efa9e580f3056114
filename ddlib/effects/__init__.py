"""What Lagrange-Euler leaves out: friction, actuators and sensors, each of which can be off.

- ``friction``: the friction laws: viscous, Coulomb, Stribeck, and stiction (`StickSlipFriction`)
- ``actuators``: saturation, dead zone, ripple, flexible shafts, computing time
- ``real_arm``: `Effects`, all of them in the order in which a signal meets them; the sensors'
  part, where an encoder is rounded (`Quantisation`), noise, delay, backlash; the book's real arm
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
