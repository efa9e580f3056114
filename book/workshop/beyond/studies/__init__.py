"""Studies of Part IV, *Rivals and beyond*.

- ``lineup``: who takes part in ``rivals``, at which sizes: a new rival is a line there
- ``rivals_1988``: tables, CMAC, polynomials and Fourier series, each varied; one trajectory alone
- ``rivals``: all rivals on the same recordings: error, stored numbers, arithmetic, training time
- ``tx40``: the real arm's recording as cases, its blocks, and models that are no networks
- ``tx40_networks``: networks on these cases
- ``real_arm``: the window network of 1988 on them, what beats it, and its filters
- ``characters``: all rivals on somebody else's data, beside a published table
- ``intervals``: whether a Gaussian process is right about how wrong it is
"""
