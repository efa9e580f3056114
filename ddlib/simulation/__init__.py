"""Arm, controller and sensors run together, each at its own rate: recordings."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
