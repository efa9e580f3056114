"""Studies of Part IV, *Closing the loop*; `PARTS` of the package above names them too."""
