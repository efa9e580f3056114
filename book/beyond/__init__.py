"""Part IV: what else learns torques, and what happens when the loop is closed.

- ``rivals``: tables, CMAC, Gaussian processes, networks of other kinds, identified equations
- ``control``: adaptive and on-line controllers, windows as feedforward
- ``others``: data that others made: a simulated arm that writes, a real arm
- ``studies``, ``measures``, ``figures``, ``chapters``: as in the rooms of the same names

It uses the workshop and `ddlib`, and neither uses it. Like the workshop it is imported with the
folder ``book`` on the path.
"""
