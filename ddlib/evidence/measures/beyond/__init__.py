"""Measures of the claims of Part IV, *Rivals and beyond*: "beyond.module.function" in a claim.

- ``rivals_1988``: section 1.1: tables, CMAC, polynomials and Fourier series
"""
