"""Functions that measure the paper's claims, for `ddlib.evidence.claims`: a module for each part.

Each returns a `ddlib.evidence.verdicts.Measured`: the value that is judged and the text that is
shown.
"""
