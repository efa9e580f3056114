"""Rivals of the window network: what else learns torques from recordings, then and now.

- ``protocol``: what all learn from, what they must answer, how they are tried: `Rival`, `trial`
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    protocol=("Cases Estimating KINDS MARGIN NotFitted Rival Trial derivative_filters trial"),
)
