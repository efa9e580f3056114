"""Studies of Part IV, *Closing the loop*.

`run_time_parts` serves `run_time`, `chain` serves `joints`, `motions` serves `stirring`, `learners`
serves `learning`; in `runs` many controllers run in one batch.
"""
