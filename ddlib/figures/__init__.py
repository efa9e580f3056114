"""The house style, and the kinds of figure that chapters share: data in, `Illustration` out.

- ``style``: the figure style: colours, fonts, light and dark, SVG with an alternative text
- ``lines``, ``maps``: curves and points over one axis; values over a plane
- ``loops``: poles and Bode plots of feedback loops
- ``many``: rows and numbers of many networks, side by side
- ``weights``: networks, Hinton diagrams, filters taken apart
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
