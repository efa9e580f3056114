"""The rigid body: arms, their equations of motion, and what computing them costs."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
