"""Studies of Part IV, *Closing the loop*."""
