"""Rivals of the window network: what else learns torques from recordings, then and now.

- ``protocol``: what all learn from, what they must answer, how they are tried: `Rival`, `trial`
- ``tables``: tables over states, motions or configurations, by cell, nearest or multilinear
- ``cmac``: overlapping tables with hashed weights, trained by the delta rule: `CMAC`
- ``bases``: polynomials and Fourier series by least squares: `Polynomial`, `Fourier`
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    protocol=("Cases Estimating KINDS MARGIN NotFitted Rival Trial derivative_filters trial"),
    tables=(
        "BEYOND Bounded CellTable GridTable Nearest OVER TableSize cells_within corners full_table "
        "table_size"
    ),
    cmac="CMAC Diverged hashed",
    bases="Basis Fourier Polynomial exponents wave_numbers",
)
