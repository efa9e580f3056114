"""Measures of Part IV, *Closing the loop*: "loop.module.function" in a claim.

- ``joints``: joints three and four, and up to seven
- ``stirring``: circles and via points, what transfers
"""
