"""Measures of Part IV, *Closing the loop*: "loop.module.function" in a claim.

- ``run_time``: torques at run time, and what predicts their end-point errors
- ``joints``: joints three and four, and up to seven
- ``stirring``: circles and via points, what transfers
- ``adaptive``: adaptive controllers
- ``learning``: learners in the loop, beside the feedback alone
- ``verdict``: what all verdicts together hang on
"""
