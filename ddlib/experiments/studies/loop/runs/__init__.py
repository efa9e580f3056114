"""Runs of many controllers in one batch, for the studies of the package above.

- ``adaptive``: adaptive controllers side by side, one motion after another
"""
