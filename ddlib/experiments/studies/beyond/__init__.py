"""Studies of Part IV, *Rivals and beyond*; `PARTS` of the package above names them too."""
