"""What trained weights do, and what data allow: filters, hidden units, coverage, noise.

- ``filters``: weights as convolution filters: their parts, derivatives, names, gains
- ``following``: which motion the outputs of filters follow along a recording
- ``response``: what units and networks respond to, in signals and in physical units; probes
- ``hidden_units``: saturation, ablation, cancellation, refitting, units matched between networks
- ``sensitivity``: which inputs and ranges a network of states responds to
- ``coverage``: what samples reach, and whether others reach the same
- ``noise``: the error that sensors leave to anybody
- ``simplified``: what simpler models of the arm lose
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
