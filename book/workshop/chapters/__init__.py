"""What one chapter alone shows: a module for each, with the chapter's name.

``status`` has the tables of the page *Status*; the others have figures.
"""
