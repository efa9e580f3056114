"""Widgets of Part IV, *Rivals and beyond*: torques and errors of all rivals.

- ``rivals``: the picker of rivals
- ``stirring``: circles of the hand in the workspace
- ``loop``: the loop with a learner inside
"""
