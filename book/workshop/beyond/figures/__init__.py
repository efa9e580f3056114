"""Figures of Part IV, *Rivals and beyond*: errors against cost, a real arm's recording.

- ``rivals``: errors of rivals against what they cost
- ``rivals_1988``: maps of what learnt one trajectory
- ``adaptive``: errors motion by motion, maps of where loops break
- ``real_arm``: friction joint by joint, gains of networks beside their nulls
- ``run_time``: what predicts the end-point error
- ``joints``: errors over motions by number of joints, what is needed, couplings
- ``stirring``: states of two families, errors on both, paths of the hand
- ``learning``: learners in the loop, trial by trial and motion by motion
"""
