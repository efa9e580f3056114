"""Studies of Part IV, *Closing the loop*.

- ``run_time_parts``: motions, feedforwards and scores of ``run_time``
- ``run_time``: section 7.1's next step: torques at run time, and the end-point error
- ``chain``: arms of one to seven joints on the report's family of motions
- ``joints``: joints three and four, and up to seven
- ``motions``: circles of the hand, several via points; what is learnt from them and asked
- ``stirring``: what transfers between these families and Appendix I
- ``adaptive``: adaptive controllers
- ``runs``: runs of many controllers in one batch
- ``learners``: what learns in the loop: draws, motions, learners that outlive a run
- ``learning``: the same, trial by trial
"""
