"""Runs of many controllers in one batch, for the studies of the package above.

- ``conditions``: on what four findings of these studies hang
- ``days``: recordings of several days
- ``lines``: feedforwards side by side
- ``adaptive``: adaptive controllers side by side, one motion after another
"""
