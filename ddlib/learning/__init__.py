"""Window networks: windows of positions, weights, and ways to train them.

- ``windows``: windows of positions, cut from a recording, and their scaling
- ``network``: `Weights` as arrays, `TorqueModel` from rad to N m
- ``training``: training sets, and the errors along a training run
- ``autograd``, ``descent``: descent with momentum, of one network in PyTorch or of many
- ``surrogates``: targets that look like torques and have nothing to do with the motion
- ``levenberg_marquardt``, ``gauss_newton``: the optimum by second-order steps
- ``span``: directions of the windows, how fast each is learnt, training of the linearised network

Only ``autograd``, ``descent``, ``levenberg_marquardt`` and ``gauss_newton`` need PyTorch.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
