"""Rivals of the window network: what else learns torques from recordings, then and now.

- ``protocol``: what all learn from, what they must answer, how they are tried: `Rival`, `trial`
- ``tables``: tables over states, motions or configurations, by cell, nearest or multilinear
- ``cmac``: overlapping tables with hashed weights, trained by the delta rule: `CMAC`
- ``bases``: polynomials and Fourier series by least squares: `Polynomial`, `Fourier`
- ``identified``: least squares on the equations of motion, and on the inputs as they are
- ``networks``: the paper's network by descent, by Levenberg-Marquardt, by Adam
- ``sequences``: convolutions along the window, and a gated recurrent unit
- ``gaussian``: Gaussian processes, alone and beside known structure, and random features
- ``lagrangian``: Deep Lagrangian Networks
"""

from ddlib._names import hand_on

__getattr__, __dir__, __all__ = hand_on(
    __name__,
    identified="Identified Linear RIDGES",
    networks="ByAdam ByDescent BySolver Network adam",
    sequences="Convolution Recurrent Sequence as_convolution",
    protocol=("Cases Estimating KINDS MARGIN NotFitted Rival Trial derivative_filters trial"),
    tables=(
        "BEYOND Bounded CellTable GridTable Nearest OVER TableSize cells_within corners full_table "
        "table_size"
    ),
    cmac="CMAC Diverged hashed",
    bases="Basis Fourier Polynomial exponents wave_numbers",
    gaussian="GaussianProcess RandomFeatures SemiParametric",
    lagrangian="AS_PUBLISHED LagrangianNetwork",
)
