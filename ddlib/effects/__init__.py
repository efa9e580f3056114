"""What Lagrange-Euler leaves out: friction, actuators and sensors, each of which can be off."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
