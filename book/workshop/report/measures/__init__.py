"""Functions that measure the paper's claims: a module for each part.

Each returns a `Measured` of ``evidence/verdicts.py``: the value that is judged and the text that is
shown. A claim names its function in ``book/claims.yml`` as "module.function"; what only reads
committed results is written there, for ``evidence/expressions.py``.

- ``dynamics``, ``backpropagation``, ``control``: sections 1 to 3, the arm and the method
- ``trajectories``, ``windows``: sections 2 to 4, motions and what windows hold
- ``networks``: Table 6-1, counts, and what the weights of networks show
- ``filters``: sections 5 and 7, what filters show
- ``filter_trial``: the same beside networks trained on unrelated torques
- ``beyond``: Part IV, rivals and a real arm
- ``loop``: Part IV, closing the loop
"""
