"""Measures of the claims of Part IV, *Rivals and beyond*: "beyond.module.function" in a claim.

- ``rivals_1988``: section 1.1: tables, CMAC, polynomials and Fourier series
- ``real_arm``: errors of the window network of 1988 on a real arm, and of what beats it
- ``real_arm_filters``: its filters, beside networks trained on unrelated currents
- ``rivals``: rivals against the paper's network, day by day
- ``characters``: rivals on somebody else's table; intervals of Gaussian processes
"""
