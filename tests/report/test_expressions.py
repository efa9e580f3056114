"""Expressions on a planted result, against numpy by hand; errors that tell what there is."""

import itertools

import numpy as np
import pytest

from workshop.report import results
from workshop.report.evidence.expressions import find
from workshop.report.evidence.verdicts import DRAWS

RNG = np.random.default_rng(0)
A, B, C = RNG.uniform(1, 3, (3, 7))
DAYS = RNG.uniform(1, 3, (6, 4))  # recordings, networks on each
FEW = [2.0, 4.0, 6.0, 8.0, 10.0]


def picked(rng, members) -> np.ndarray:
    return rng.integers(0, members, (DRAWS, members))


@pytest.fixture(autouse=True)
def planted(monkeypatch):
    result = {
        "a": A.tolist(), "b": B.tolist(), "c": C.tolist(), "few": FEW, "days": DAYS.tolist(),
        "one": [2.0], "number": 2.0, "count": 1234, "signed": [-1.0, -3.0, 2.0, -2.0, 2.5],
        "stopped": [1.0, 2.0, None, 3.0, None],
        "windows": {"11": A.tolist(), "21": (2 * A).tolist(), "41": (0.5 * B).tolist()},
        "rows": [
            {"width": 11, "kind": "x", "e": A.tolist()}, {"width": 21, "kind": "x", "e": FEW},
            {"width": 21, "kind": "y, z", "e": B.tolist()},
        ],
        "in 2/3 of the time": {"e": FEW}, "seeds": [{"e": x, "f": [x, 2 * x]} for x in FEW],
        "classes": {"up": [0.1, 0.2] * 3, "down": [0.3, 0.4] * 3},
    }  # fmt: skip
    monkeypatch.setattr(results, "read", {"r": result, "s": {"a": FEW}}.__getitem__)


def found(text="{value}", arguments=None, **entry):
    return find({"text": text, **entry}, arguments)


def test_values_by_hand():
    med = np.median
    for entry, wanted in (
        ({"median": "r/a"}, med(A)),
        ({"mean": "r/a"}, A.mean()),
        ({"root mean": "r/days"}, np.sqrt(DAYS.mean())),
        ({"min": {"rms": "r/days"}}, np.sqrt(np.mean(DAYS**2, axis=1)).min()),
        ({"median": {"size": "r/signed"}}, 2.0),
        ({"median": {"over": ["r/a", "r/b"]}}, med(A / B)),
        ({"median": {"over": ["r/a", "r/few"]}}, med(A[:5] / FEW)),  # cut to the fewest
        ({"median": {"over": ["r/a", "r/number"]}}, med(A) / 2),
        ({"mean": {"above": ["r/a", {"times": [1.1, "r/b"]}]}}, np.mean(A > 1.1 * B)),
        ({"mean": {"less": [{"plus": ["r/a", "r/b"]}, "r/c"]}}, np.mean(A + B - C)),
        ({"median": {"lesser": ["r/a", "r/b"]}}, med(np.minimum(A, B))),
        ({"mean": {"average": ["r/a", "r/b", "r/c"]}}, np.mean([A, B, C])),
        ({"mean": {"medians": "r/days"}}, med(DAYS, axis=1).mean()),
        ({"mean": {"rms": "r/days"}}, np.sqrt((DAYS**2).mean(1)).mean()),
        ({"max": "r/days"}, DAYS.max()),
        ({"min": "r/a"}, A.min()),
        ({"ratio": ["r/a", "r/b"]}, med(A) / med(B)),
        ({"ratio": ["r/few", {"mean": "r/one"}]}, 3.0),
        ({"difference": [{"mean": "r/a"}, {"mean": "r/b"}]}, A.mean() - B.mean()),
        ({"deviation": {"ratio": ["r/a", "r/b"]}}, abs(med(A) / med(B) - 1)),
        ({"largest": ["r/a", "r/b", "r/c"]}, max(map(med, (A, B, C)))),
        ({"least": ["r/a", "r/b", "r/c"]}, min(map(med, (A, B, C)))),
        ({"excess": ["r/a", "r/b", "r/c"]}, med(A) - max(med(B), med(C))),
        ({"furthest": ["r/number", "r/windows/41"]}, 2.0),
        ({"apart": [{"ratio": ["r/number", 8]}, "r/number"]}, 4.0),
        ({"median": "r/stopped"}, 3.0),
    ):  # fmt: skip
        assert found(**entry).value == pytest.approx(wanted, rel=1e-12), entry


def test_paths_lead_to_members():
    for path, wanted in (
        ("s/a", FEW),
        ("r/rows/width=11/e", A),
        ("r/rows/width=21&kind=y, z/e", B),
        ("r/rows/1/e", FEW),
        ("r/a/1:-1", A[1:-1]),
        ("r/seeds/:/f/1:", np.multiply(2, FEW)),
        ("r/days/:5/-1", DAYS[:5, -1]),
        ("r/in 2/3 of the time/e", FEW),
        ("r/days/:/2", DAYS[:, 2]),
        ("r/classes/up|down", [0.4, 0.6] * 3),
        ("r/nothing or r/few", FEW),
        ("r/few or r/a", FEW),
    ):
        assert found(median=path).value == pytest.approx(np.median(wanted)), path


def test_cells_are_drawn_one_after_another_in_the_order_of_their_names():
    rng = np.random.default_rng(0)
    a, b = A[picked(rng, 7)], B[picked(rng, 7)]
    same = found(ratio=["r/a", "r/b"]).replicates
    np.testing.assert_array_equal(same, np.median(a, 1) / np.median(b, 1))
    other = found(ratio=["y", "x"], of={"x": "r/a", "unused": "r/c", "y": "r/b"}).replicates
    np.testing.assert_array_equal(other, np.median(b, 1) / np.median(a, 1))
    # a cell that is named twice is drawn once
    thrice = found(least=[{"ratio": ["r/a", "r/b"]}, {"ratio": ["r/a", "r/b"]}]).replicates
    np.testing.assert_array_equal(thrice, same)


def test_pairs_are_drawn_together_and_what_is_fixed_is_not():
    pick = picked(np.random.default_rng(0), 7)
    a = np.median(A[pick], 1)
    pairs = found(paired={"ratio": ["r/a", "r/b"]}).replicates
    np.testing.assert_array_equal(pairs, a / np.median(B[pick], 1))
    each = found(median={"over": ["r/a", "r/b"]}).replicates
    np.testing.assert_array_equal(each, np.median((A / B)[pick], 1))
    for held in ({"median": "r/b"}, {"paired": {"largest": ["r/b", 0]}}):
        fixed = found(ratio=["r/a", {"fixed": held}]).replicates
        np.testing.assert_array_equal(fixed, a / np.median(B))
    alone = found(ratio=["r/a", "r/one"]).replicates
    np.testing.assert_array_equal(alone, a / 2)
    assert found(ratio=["r/number", "r/one"]) == (1.0, "1.0", None)


def test_members_of_members():
    rng = np.random.default_rng(0)
    days = picked(rng, 6)[..., None]
    drawn = DAYS[days, rng.integers(0, 4, (DRAWS, 6, 4))]
    wanted = np.median(drawn.reshape(DRAWS, -1), 1)
    np.testing.assert_array_equal(found(median="r/days", nested=True).replicates, wanted)
    np.testing.assert_array_equal(  # what has no members of members is drawn as ever
        found(median="r/a", nested=True).replicates, found(median="r/a").replicates
    )
    mixed = found(
        paired={"ratio": [{"root mean": "r/days"}, {"root mean": "r/classes/up"}]}, nested=True
    )
    up = np.array([0.1, 0.2] * 3)[days[..., 0]]
    np.testing.assert_allclose(
        mixed.replicates, np.sqrt(drawn.mean((1, 2))) / np.sqrt(up.mean(1)), rtol=1e-12
    )


def test_for_goes_through_values_and_with_fills_in():
    loop = {"w": [11, 21, 41]}
    worst = found("{each}; {each[1]:3}; {each:min}", largest="r/windows/{w}", **{"for": loop})
    assert worst.value == pytest.approx(2 * np.median(A))
    medians = [np.median(A), 2 * np.median(A), np.median(B) / 2]
    told = ", ".join(f"{m:.1f}" for m in medians[:2]) + f", {medians[2]:.2g}"
    assert worst.text == f"{told}; {medians[1]:.2f}; {medians[2]:.2g}"
    leasts = [{"least": "r/windows/{w}", "for": {"w": ws}} for ws in ([11, 21], [11, 21, 41])]
    where = found("{least[0]} at {at[0]}, {least[1]} at {at[1]}", ratio=leasts)
    assert where.text == f"{medians[0]:.1f} at 11, {medians[2]:.2g} at 41"
    where = {"least": "r/windows/{w}", "for": loop}
    least = found("{least[0]} at {at[0]}", ratio=[where, "r/few"])
    assert least.value == pytest.approx(min(medians) / 6)
    assert least.text == f"{min(medians):.2g} at {loop['w'][int(np.argmin(medians))]}"
    best = found("{value:.0f}", best="r/windows/{w}", **{"for": loop})
    assert best.value == 41 and best.text == "41" and set(best.replicates) <= {11, 21, 41}
    by_name = found(
        largest="{r}/windows/{w}", arguments={"ws": [11, 41], "r": "r"}, **{"for": {"w": "ws"}}
    )
    assert by_name.value == pytest.approx(np.median(A))  # fmt: skip
    pair = {"over": ["r/windows/{w}", "r/a"]}
    assert found(largest=pair, **{"for": {"w": [11, 21]}}).value == pytest.approx(2)


@pytest.mark.parametrize(
    "order, holds",
    [([41, 11, 21], True), ([11, 41, 21], False), ([[11, 41], 21], True), ([41, [11, 21]], True)],
)
def test_orders(order, holds):
    loop = {"w": [11, 21, 41]}
    given = found("{draws:mean .0%}", rising="r/windows/{w}", order=order, **{"for": loop})
    assert given.value is holds and given.text == f"{100 * given.replicates.mean():.0f} %"
    rng = np.random.default_rng(0)
    cells = {11: A, 21: 2 * A, 41: 0.5 * B}
    drawn = {w: np.median(cell[picked(rng, 7)], 1) for w, cell in cells.items()}
    levels = [[drawn[w] for w in np.atleast_1d(level)] for level in order]
    wanted = [np.max(x, 0) < np.min(y, 0) for x, y in itertools.pairwise(levels)]
    np.testing.assert_array_equal(given.replicates, np.all(wanted, 0))
    alike = found(rising="r/few", order=[1, 2], **{"for": {"w": [1, 2]}})
    assert alike.value is False  # equal is no order


def test_words():
    for template, wanted in (
        ("{0}", "6.0"),
        ("{0:spread 3}", "6.00 (2.00 to 10.0)"),
        ("{0:mean .0%}", "600 %"),
        ("{0:max}, {0:min .1f}, {0:sum .0f} of {0:count d}", "10, 2.0, 30 of 5"),
        ("{0:root 3}", f"{np.sqrt(6):.2f}"),
        ("{0:root} of {0:count}: {0:all .0f}", "2.4 of 5: 2, 4, 6, 8, 10"),
        ("{small:power}", "10⁻⁹"),
        ("{count}", "1,234"),
        ("{count:d}", "1234"),
        ("{value} for {colour}", "6.0 for red"),
        ("{other:p .2f}", f"{(1 + 3) / (1 + 5):.2f}"),  # 6, 8 and 10 of 5, and itself
    ):
        names = {"count": "r/count", "other": "s/a", "small": 1e-9}
        given = find({"median": "r/few", "of": names, "text": template}, {"colour": "red"})
        assert given.text == wanted, template


def test_mistakes_are_told_with_what_there_is():
    for entry, words in (
        ({"median": "r/d"}, r"'r/d': at 'd' there is 'a', 'b'"),
        ({"quotient": ["r/a", "r/b"]}, r"form must be one of ratio, .* got 'quotient'"),
    ):
        with pytest.raises(ValueError, match=words):
            found(**entry)
