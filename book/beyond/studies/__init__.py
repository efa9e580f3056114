"""Studies of *Rivals and beyond*; those of *Closing the loop* are in `loop`; see `lineup` first."""
