"""Studies of *Closing the loop*; in `runs` many controllers run in one batch."""
