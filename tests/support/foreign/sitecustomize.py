"""Jogs every random draw of NumPy: loaded by each Python process that finds it on its path.

With ``DDLIB_JOG=k`` in the environment every real number that a generator of
`numpy.random.default_rng` draws is multiplied by ``1 + k 1e-9``. Initial weights, sensor noise and
random states are then others in their last digits, as they are on a processor that rounds
otherwise; after thousands of epochs so are the networks. Integers and permutations stay.
"""

import os

JOG = os.environ.get("DDLIB_JOG")

if JOG:
    import numpy as np

    FACTOR = 1 + float(JOG) * 1e-9
    _plain = np.random.default_rng

    def _jogged(name):
        drawn = getattr(np.random.Generator, name)

        def draw(self, *args, **options):
            return drawn(self, *args, **options) * FACTOR

        return draw

    REAL = ("random", "uniform", "normal", "standard_normal", "exponential", "triangular")
    Jogged = type("Jogged", (np.random.Generator,), {name: _jogged(name) for name in REAL})

    def default_rng(seed=None):
        """As NumPy's, but its draws are jogged."""
        return Jogged(_plain(seed).bit_generator)

    np.random.default_rng = default_rng
