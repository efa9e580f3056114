"""Studies of Part IV, *Closing the loop*; `PARTS` of the package above names them too.

- ``chain``: arms of one to seven joints on the report's family of motions
- ``joints``: joints three and four, and up to seven
- ``motions``: circles of the hand, several via points; what is learnt from them and asked
- ``stirring``: what transfers between these families and Appendix I
"""
