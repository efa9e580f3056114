"""Studies of Part IV, *Rivals and beyond*; those of *Closing the loop* are in `loop`.

A new rival is a line in `lineup`; `tx40` serves `real_arm`.
"""
