"""How a package hands on the names of its modules: each is imported when it is first asked for."""

from __future__ import annotations

import lazy_loader


def hand_on(package: str, *submodules: str, **names: str) -> tuple:
    """``__getattr__, __dir__, __all__`` of a package.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    *submodules : str
        Modules that are used as such: ``from ddlib.experiments import results``.
    **names : str
        By module, the names that can be imported from the package, separated by blanks.
    """
    found = {module: text.split() for module, text in names.items()}
    return lazy_loader.attach(package, submodules=submodules, submod_attrs=found)
