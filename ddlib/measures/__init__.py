"""Functions that measure the paper's claims, for `ddlib.claims`: one module for each part.

Each returns a `ddlib.verdicts.Measured`: the value that is judged and the text that is shown.
"""
