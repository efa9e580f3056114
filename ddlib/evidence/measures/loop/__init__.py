"""Measures of Part IV, *Closing the loop*: "loop.module.function" in a claim.

- ``verdict``: what all verdicts together hang on
"""
