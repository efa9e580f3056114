"""The book's figures: data in, `Illustration` out. No plot detail lives in a chapter.

- ``style``: the figure style: colours, fonts, light and dark, SVG with an alternative text
- ``lines``, ``maps``: curves over one axis, of one network or many; values over a plane
- ``weights``: networks, Hinton diagrams, filters taken apart
- ``dynamics``, ``effects``, ``control``, ``recording``, ``states``: figures of one chapter each
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
