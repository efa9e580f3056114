"""Parameters of an arm from recordings of it, with a confidence for each.

- ``equations``: from a recording to linear equations: differences, smoothing, modulation
- ``known_axes``: six joints of which only the axes are known, joint by joint
- ``recursive``: least squares one sample at a time
- ``regression``: weighted least squares on them, `Estimate`, and the true parameters
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
