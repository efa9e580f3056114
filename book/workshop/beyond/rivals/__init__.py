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
