"""Measures of the claims of Part IV, *Rivals and beyond*: "beyond.module.function" in a claim.

- ``rivals``: against the paper's network, on somebody else's table, and intervals
- ``rivals_1988``: section 1.1: tables, CMAC, polynomials and Fourier series
- ``real_arm``, ``real_arm_filters``: the window network of 1988 on a real arm
"""
