"""Window networks: windows of positions, weights, and ways to train them.

Only `autograd`, `descent`, `levenberg_marquardt` and `gauss_newton` need PyTorch.
"""

import lazy_loader

_loaded, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name):
    try:
        return _loaded(name)
    except ModuleNotFoundError as error:
        if error.name != "torch":
            raise
        raise ImportError(
            f'ddlib.learning.{name} needs PyTorch: pip install "direct-drive-arm[learning]"',
            name="torch",
        ) from None
