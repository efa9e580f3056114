"""Studies of Part IV, *Rivals and beyond*; those of *Closing the loop* are in `loop`."""
