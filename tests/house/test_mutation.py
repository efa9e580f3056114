"""The mutants: each change is one that was meant, and nothing else changes."""

import ast

import mutation
import pytest
import yaml
from mutators import mutants_of


def changed(source: str) -> set[str]:
    return {mutant.apply(source) for mutant in mutants_of("m", source)}


@pytest.mark.parametrize(
    "source, wanted",
    [
        ("x = a + b", {"x = (a - b)"}),
        ("x = a ** b", {"x = (a * b)"}),
        ("x += a", {"x -= a"}),
        ("x = -a", {"x = a"}),
        ("x = not a", {"x = a"}),
        ("x = a < b", {"x = (a <= b)", "x = (a >= b)"}),
        ("x = a is b", {"x = (a is not b)"}),
        ("x = a and b", {"x = (a or b)"}),
        ("x = 3", {"x = 4"}),
        ("x = 2.0", {"x = 2.2"}),
        ("x = 0.0", {"x = 1.0"}),
        ("x = True", {"x = False"}),
        ("x = a[:n]", {"x = a[:n + 1]"}),
        ("x = a[n:]", {"x = a[n + 1:]"}),
        ("x = np.max(a)", {"x = np.min(a)"}),
        ("x = a.argmax()", {"x = a.argmin()"}),
        ("x = min(a)", {"x = max(a)"}),
        ("x = np.sqrt(a)", {"x = a"}),
        ("x = f(a, k=b)", {"x = f(a)"}),
        ("f(a)", {"pass"}),
        ("x = a if b else c", {"x = a if (not b) else c"}),
    ],
)
def test_changes(source, wanted):
    assert changed(source) == wanted


@pytest.mark.parametrize(
    "source",
    [
        '"""Words."""',
        "import a as b",
        '__all__ = ["a" + b]',
        "raise ValueError(f'{a + 1}' + b)",
        "def f(x: tuple[1, 2]) -> Literal[3]: ...",
        "@lru_cache(maxsize=8)\ndef f(x): ...",
        "for x in tqdm(a, disable=not b): ...",
        "print(3)",
        "if __name__ == '__main__':\n    main(3)",
        "x = 'words' + a",
    ],
)
def test_what_stays(source):
    assert changed(source) == set()


def test_inside_a_formatted_text():
    source = 'x = f"{a + 1:.2f} of {b}"'
    assert {ast.dump(ast.parse(text)) for text in changed(source)} == {
        ast.dump(ast.parse(text))
        for text in ('x = f"{a - 1:.2f} of {b}"', 'x = f"{a + 2:.2f} of {b}"')
    }


SOURCE = '''\
SCALE = 3


def f(x, k=2):
    """Words with é, which takes two bytes."""
    if x < k:
        return x
    return (
        x
        * k
    )
'''


def test_lines_and_scopes():
    found = {(m.operator, m.lines, m.scope, m.at_import) for m in mutants_of("m", SOURCE)}
    assert found == {
        ("constant", (1,), (1, 11), True),
        ("constant", (4,), (5, 11), True),
        ("comparison", (6,), (4, 11), False),
        ("arithmetic", (8, 9, 10, 11), (4, 11), False),
    }


def test_identifiers_stay_when_other_lines_change():
    before = {m.id for m in mutants_of("m", SOURCE)}
    after = {m.id for m in mutants_of("m", "# more\n" + SOURCE.replace("x < k", "x > k"))}
    assert len(before) == 5 and len(before & after) == 3


def test_text_with_wide_characters():
    assert changed('x = "é", a + b') == {'x = "é", (a - b)'}


def test_samples_are_drawn_anew_with_each_seed():
    first, again, other = (mutation.draw(seed, 50, "measures") for seed in (1, 1, 2))
    assert first == again and len(set(first) & set(other)) < 25
    assert all(m.module.startswith("evidence/measures/") for m in first)
    assert mutation.draw(1, 60, "measures")[:50] == first


def test_pages_and_pictures_are_left_out():
    found = mutation.modules()
    assert {"dynamics/arm", "evidence/measures/networks", "learning/training", "_check"} <= set(
        found
    )
    assert not [name for name in found if "figures" in name or "widgets" in name]


def known(tests, lines, failed=()):
    return {"seconds": dict(tests), "lines": {"arm": lines}, "failed": list(failed)}


def test_which_tests_run(monkeypatch):
    (mutant, *_) = mutants_of("arm", "def f(a, b):\n    return a + b\n")
    one = {"t/test_x.py::a": 5.0, "t/test_x.py::b": 1.0, "t/test_x.py::c": 0.1}
    own = {"t/test_arm.py::a": 9.0, "t/test_arm.py::broken": 0.1}
    files = {
        "test_x.py": known(one, {"2": ["t/test_x.py::a", "t/test_x.py::b"]}),
        "test_arm.py": known(own, {"2": list(own)}, ["t/test_arm.py::broken"]),
        "test_y.py": known({"t/test_y.py::a": 0.1}, {"1": []}),
    }
    assert mutation.tests_for(mutant, files) == [
        "t/test_arm.py::a", "t/test_x.py::b", "t/test_x.py::a", "t/test_x.py::c",
    ]  # fmt: skip
    monkeypatch.setattr(mutation, "TESTS_SECONDS", 6.0)
    assert mutation.tests_for(mutant, files) == [
        "t/test_x.py::b", "t/test_x.py::a",
    ]  # fmt: skip


def test_constants_are_tried_by_the_tests_of_their_module():
    """A module of constants runs when it is imported, and no line of it in any test."""
    (mutant, *_) = mutants_of("arm", "MASS = 3.0\n")
    files = {
        "t/test_x.py": known({"t/test_x.py::a": 1.0}, {}),
        "t/test_arm.py": known({"t/test_arm.py::a": 1.0}, {}),
    }
    assert mutation.tests_for(mutant, files) == ["t/test_arm.py::a"]


def test_scores_count_the_equivalent_apart():
    mutants = mutation.draw(1, 4, "library")
    outcomes = ["killed", "killed", "survived", "survived"]
    rows = [(m, {"outcome": o, "by": "3 tests"}) for m, o in zip(mutants, outcomes)]
    text = mutation.report(rows, {mutants[2].id: "since"})
    assert "library: 4 mutants, 2 killed, 1 survived, 1 judged equivalent" in text
    assert "score 50.0%, without the equivalent 66.7%" in text
    assert f"{mutants[2].id} {mutants[2].operator} (equivalent: since)" in text
    assert "judged equivalent, and killed" in mutation.report(rows, {mutants[0].id: "since"})


def test_judgements_have_reasons():
    entries = yaml.safe_load(mutation.JUDGED.read_text(encoding="utf-8"))
    assert all(set(entry) == {"id", "where", "change", "why"} for entry in entries)
    assert all(len(entry["why"].split()) >= 4 for entry in entries)
    assert len({entry["id"] for entry in entries}) == len(entries)
    modules = {mutant.id: mutant.module for mutant in mutation.every_mutant()}
    for entry in entries:  # an identifier lives as long as its line and its module's name
        assert modules.get(entry["id"]) == entry["where"].split(",")[0], entry
