"""What one chapter alone shows: a module for each, with the chapter's name.

``ledger`` and ``status`` have tables, ``widgets`` what is handled; the others have figures.
"""
