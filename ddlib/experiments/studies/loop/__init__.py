"""Studies of Part IV, *Closing the loop*; `PARTS` of the package above names them too.

- ``chain``: arms of one to seven joints on the report's family of motions
- ``joints``: joints three and four, and up to seven
"""
