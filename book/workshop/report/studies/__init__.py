"""What is too slow for a chapter: the studies that ``make reproduce`` repeats.

A study is a function without required arguments and with the decorator `study`, which returns a
plain dictionary. ``python -m workshop.report.reproduce NAME`` runs one.

- ``table``, ``screening``: Table 4-1, on other days, longer, with clean sensors; what moves it
- ``windows``: window sizes, hidden units, states in place of windows, acceleration
- ``nulls``, ``harmonics``: unrelated torques, other starts and ends; other motions
- ``targets``: velocity filters by what is learnt, and by the size of the initial weights
- ``planted``: what is read, and what a knob does, where it is known what was learnt
- ``twins``: two rows of one shape, one of the arm and one of a spring
- ``span``: learning curves along the directions of the windows
- ``states``: section 6
- ``page``: networks that readers train in the pages
"""
