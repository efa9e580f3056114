"""Controllers of the joints, the linear analysis of their loops, velocity from positions."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
