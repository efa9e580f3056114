"""Functions that measure the paper's claims: a module for each part.

Each returns a `Measured` of ``evidence/verdicts.py``: the value that is judged and the text that is
shown. A claim names its function in ``book/claims.yml`` as "module.function". What one chapter
shows by itself is measured in its module of `workshop.chapters`; what only reads committed results
is written in the claim, for ``evidence/expressions.py``.

- ``windows``: sections 2 to 4, what windows hold, what networks cost, how training goes
- ``filters``: sections 5 and 7, what filters show
- ``filter_trial``: the same beside networks trained on unrelated torques
"""
