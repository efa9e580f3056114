"""What one chapter of Part IV alone shows: a module for each, with the chapter's name.

As in `workshop.chapters`, ``widgets`` has what is handled.
"""

from functools import partial

from workshop import chapters

quoted = partial(chapters.quoted, package=__name__)
"""Quote the numbers of a chapter's prose: `workshop.chapters.quoted` for modules of this one."""
