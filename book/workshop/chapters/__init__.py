"""What one chapter alone shows: a module for each, with the chapter's name.

Most have its figures and what its claims measure, ``ledger`` and ``status`` their tables,
``widgets`` what is handled.
"""
