"""Interactive figures: at any setting with a kernel, at those of a table in the built page.

- ``picker``, ``switches``: a widget each, named after what the reader handles
- ``engine``: widgets that compute in the page, and the live engine that they share
- ``base``: `CurveWidget`, a function of a few parameters that returns curves; ``table``: its curves
  at every setting, for the page; ``still``: its start as a picture
- ``parts``: parameters, panels, pads
- ``static``: the page's half: scripts that all widgets share (``curves.js``, ...), and one more for
  each that draws something of its own (``picker.js``)
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
