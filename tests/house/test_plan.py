"""The plan of the house: where a newcomer looks, everything is said, and said in order."""

import ast
import re
from pathlib import Path

import pytest
from test_imports import ORDER, PACKAGES, ROOT

import ddlib


def docstring(package: Path) -> str:
    return ast.get_docstring(ast.parse((package / "__init__.py").read_text(encoding="utf-8")))


def test_the_picture_shows_every_room_in_order():
    rooms = re.findall(r"^    (\w+)  +\S", ddlib.__doc__, re.MULTILINE)
    assert tuple(rooms) == ORDER


@pytest.mark.parametrize("package", PACKAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_a_package_says_what_each_of_its_modules_is_for(package):
    modules = {path.stem for path in package.glob("*.py")} - {"__init__"}
    inside = modules | {path.parent.name for path in package.glob("*/*.py")}
    named = set(re.findall(r"``(\w+)``", docstring(package)))
    assert inside <= named
