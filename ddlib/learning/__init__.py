"""Window networks: windows of positions, weights, and ways to train them.

Only `autograd`, `descent`, `levenberg_marquardt` and `gauss_newton` need PyTorch.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
