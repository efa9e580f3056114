"""What trained weights do, and what data allow: filters, hidden units, coverage, noise."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
