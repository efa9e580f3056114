"""What one chapter alone shows: ``status``, tables of the page *Status*."""
