"""Measures of Part IV, *Closing the loop*: "loop.module.function" in a claim.

- ``run_time``: torques at run time: end-point errors of feedforwards, and what predicts them
- ``joints``: joints three and four, and up to seven
- ``stirring``: circles and via points, what transfers
- ``adaptive``: adaptive controllers
- ``learning``: learners in the loop, beside the feedback alone
- ``conditions``: four of these findings under other conditions
- ``verdict``: what all verdicts together hang on
"""
