"""All figures of the book: sound, accessible, small, without an id that another has."""

import inspect
import pkgutil
from importlib import import_module

import pytest
from figure_examples import EXAMPLES, made
from pictures import black_or_white, check_sound, ids, words

from ddlib import figures
from workshop import chapters
from workshop.beyond import figures as beyond

UPON_A_COLOUR = {
    "ranking": "#000000", "hinton": "#ffffff", "hinton_states": "#ffffff", "plane": "#ffffff",
    "maps": "#ffffff", "hand_paths": "#ffffff", "arm_sketch": "#ffffff",
}  # fmt: skip
"""What these paint black or white lies on a colour, or has an edge in the page's ink."""


def test_every_figure_has_an_example():
    modules = [beyond]
    for package in (figures, chapters):
        names = [module.name for module in pkgutil.iter_modules(package.__path__)]
        modules += [
            import_module(f"{package.__name__}.{name}") for name in names if name != "style"
        ]
    drawing = {
        name
        for module in modules
        for name, function in inspect.getmembers(module, inspect.isfunction)
        if function.__module__ == module.__name__ and name[0] != "_"
        if inspect.signature(function).return_annotation == "Illustration"
    }
    assert drawing == {name.partition(",")[0] for name in EXAMPLES} and len(drawing) > 40


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_and_accessible(name):
    picture, _ = made(name)
    check_sound(picture)
    assert black_or_white(picture) <= ({UPON_A_COLOUR.get(name)})
    assert len(picture.svg) < (400_000 if name == "hinton" else 150_000)


def test_no_two_figures_share_an_id():
    every = [name for key in EXAMPLES for name in ids(made(key)[0].svg)]
    assert len(every) == len(set(every)) > 20


@pytest.mark.parametrize(
    "name, told",
    [
        ("courses", {"A", "B", "one", "two", "a load", "error, mm", "motion, number"}),
        ("growth", {"found", "a law", "2", "4", "7"}),
        ("gains_by_joint", {"unrelated currents", "real currents", "as identified"}),
        (
            "costs",
            {"tables", "bases", "one", "two", "three", "network", "test", "training", "noise"},
        ),
        ("intervals", {"a", "b", "gain", "friction"}),
        ("predicted_curves", {"slow", "fast", "predicted", "one", "two"}),
        ("against_nulls", {"hidden", "direct", "velocity", "jerk", "real", "one", "two"}),
    ],
)
def test_figures_name_what_they_show(name, told):
    assert told <= set(words(made(name)[0]))
