"""Functions that measure the paper's claims, for `ddlib.claims`: one module for each part.

Each returns a `ddlib.claims.Measured`: the value that is judged and the text that is shown.
"""
