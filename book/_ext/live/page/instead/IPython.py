"""*Run this page*: in a page this is `IPython`, of which `display` is left."""

from __future__ import annotations

import sys
import types

import kernel

version_info = (9, 0)  # Matplotlib asks, before it draws for an older one


def get_ipython():
    """None: there is no shell."""


display = types.ModuleType("IPython.display")
display.display = kernel.display
sys.modules[display.__name__] = display
