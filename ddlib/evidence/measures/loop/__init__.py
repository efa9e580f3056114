"""Measures of Part IV, *Closing the loop*: "loop.module.function" in a claim.

- ``joints``: joints three and four, and up to seven
"""
