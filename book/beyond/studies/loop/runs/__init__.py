"""Runs of many controllers in one batch, for the studies of the package above."""
