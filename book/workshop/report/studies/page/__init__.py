"""What readers try in the pages, many times over.

- ``training``: networks trained as a reader trains one: when errors go, and shapes come
- ``learner``: a learner in the loop, for each choice that its widget offers
"""
