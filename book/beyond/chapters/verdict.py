"""The lesson *Verdict of the book*, and its evidence: verdicts by section, reading, arm, draw."""

from __future__ import annotations

import re
import textwrap
import warnings
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from beyond.chapters.rivals import over
from beyond.measures import rivals
from ddlib.figures import COLOURS, FAINT, INK, Illustration, illustrate, legend_above
from ddlib.figures.style import NARROW
from ddlib.setups import SETUPS, WINDOWS
from ddlib.tables import Table, quote, typeset
from workshop.chapters import excitation, planted, start, window_size
from workshop.chapters.exercises import Exercise, judging
from workshop.report import results
from workshop.report.evidence import cards, claims
from workshop.report.evidence.cards import by_reading, of_kind, tally, worded
from workshop.report.evidence.claims import SECTIONS, Claim, load
from workshop.report.evidence.statements import resampled, stated
from workshop.report.evidence.verdicts import Measured
from workshop.report.evidence.wall import home, window
from workshop.report.measures import filter_trial as trial

# How a bar's parts look, in the order of the words
_LOOKS = (
    {"color": COLOURS[1]},
    {"color": COLOURS[2], "alpha": 0.75},
    {"facecolor": f"{COLOURS[1]}33", "edgecolor": COLOURS[1], "lw": 1},
    {"color": COLOURS[0]},
    {"color": COLOURS[4], "alpha": 0.75},
)

_DIGIT = 5.4  # Width of a digit in a bar, points

_SHUFFLES = 10_000  # permutations that stand for chance

# Cards of the first figure, one for each word while it has that word
_EXAMPLES = ("speed", "figure-4-1", "test-21", "strikingly-asymmetric", "conventional-filters")

# Rows of the ledger that the verdict sums up
_SUMMED = (
    "unmodelled-error-real-arm",
    "differencing",
    "better-on-training-damping",
    "training-falls-damping",
    "table-degrades",
    "vast-amount",
    "generalised-well",
    "parity-network",
    "accurate-torques-damping",
    "conventional-filters-shapes",
    "conventional-filters",
    "conventional-filters-inertia",
    "memorises",
    "tradeoff",
    "network-against-identification",
    "network-against-linear",
    "hidden-units-contribute-test",
)


def _verdicts(*ids: str) -> list[str]:
    known = {claim.id: claim.verdict for claim in load()}
    return [known[name] for name in ids]


def _orders() -> dict[str, float]:
    """How often networks drawn one of each window have the printed order, by reading."""
    cells, shares = results.read("table-4-1")["setups"], {}
    for name in SETUPS:
        short, middle, long = (np.array(cells[name][str(w)]["errors"]["test"]) for w in WINDOWS)
        above = [(other > middle[:, None]).mean(1) for other in (short, long)]
        shares[name] = float((above[0] * above[1]).mean())
    return shares


def _acceleration() -> tuple[np.ndarray, list[float]]:
    """Shares of acceleration filters in hidden units of window 21, and means under each null."""
    row, name = trial.row(21), ["acceleration"]
    nulls = [trial.share(x, "hidden", name).mean() for x in trial.matched(row).values()]
    return trial.share(row["real"], "hidden", name), nulls


def _velocity_by_solver() -> dict[str, float]:
    """Shares of velocity filters in hidden units that the solver trained, by the torques."""
    row = trial.row("solver")
    by_torques = {"real": row["real"], **row["nulls"]}
    return {name: trial.share(x, "hidden", ["velocity"]).mean() for name, x in by_torques.items()}


def _places() -> list[tuple[str, float]]:
    """Readings and starts that were trained beside unrelated torques."""
    return [(reading, size) for reading in SETUPS for size in results.read("start-nulls")["ranges"]]


def _beyond_all(reading: str, size: float) -> bool:
    """Whether networks hold more inertia, in the median, than any of unrelated torques."""
    row = start.null_row(reading, size)
    null = max(np.max(row[kind]["M11"]) for kind in row if kind != "real")
    return bool(np.median(row["real"]["M11"]) > null)


def names_table() -> Table:
    """Shares of acceleration and velocity filters, with the arm's torques and unrelated ones."""
    rows = []
    for reading in SETUPS:
        for size in (0.03, 0.3):
            shares = []
            for name in ("acceleration", "velocity"):
                by_torques = start.shares_beside(reading, size, name)
                own, *others = (100 * x.mean() for x in by_torques.values())
                shares += [f"{own:.0f}", " and ".join(f"{x:.0f}" for x in others)]
            rows.append((reading, f"±{size:g}", *shares))
    heads = "acceleration, %", "by unrelated torques", "velocity, %", "by unrelated torques"
    return Table(("reading", "start", *heads), rows)


def inertias_table() -> Table:
    """The shoulder's inertia in networks, and in the arm, in the median."""
    rows = []
    for name, width in (("damped joints, window 21", 21), ("damped joints, window 11", 11)):
        inertia = np.array(trial.row(width)["real"]["gains"])[:, 0, 0, 2]
        rows.append((name, np.median(inertia), trial.arm_gains()[0, 0, 2]))
    lost = excitation.cell("state feedback", 1.0)
    cut = "the controller damps, first second cut"
    rows.append((cut, np.median(lost["descent"]["M11"][-1]), lost["arm"]))
    rows.append((f"{cut}, by a solver", np.median(lost["solver"]["M11"]), lost["arm"]))
    heads = "networks", "shoulder's inertia, kg m²", "the arm's"
    return Table(heads, [(name, f"{median:.1f}", f"{own:.1f}") for name, median, own in rows])


def _quoted() -> None:
    """Numbers of the lesson."""
    sentences = of_kind("system")
    quote("verdict-claims", len(sentences))
    best, under = next(iter(by_reading(sentences).items()))
    quote("verdict-best", best)
    quote("verdict-best-reproduced", under["reproduced"])
    quote("verdict-reproduced", tally(sentences)["reproduced"])
    without, friction = claims.measured("unmodelled-error-real-arm").text.split(", ")
    quote("verdict-rigid", without.split()[0])
    quote("verdict-friction", friction.split()[0])
    quote("verdict-behind", window_size.behind_least_squares().sum())
    quote("verdict-another-day", claims.measured("memorises-damping").value)
    quote("verdict-knob", planted.every("the arm", "knob").mean())
    solver = _velocity_by_solver()
    quote("verdict-solver", 100 * solver["real"])
    quote("verdict-solver-phases", 100 * solver["phases"])
    least, most = start.agree_by_direct()
    quote("verdict-direct-least", f"{least:g}")
    quote("verdict-direct-most", f"{most:g}")
    for name, share in _orders().items():
        quote(f"verdict-order-{name.split()[0]}", 100 * share)
    quote("verdict-six-identified", np.median(over("identified")))
    fewer, all_of_them = rivals.better().text.split(":")[0].split(" of ")
    quote("verdict-ahead", fewer)
    quote("verdict-rivals", all_of_them)
    groups = _by_reading(claims.of_the_paper())
    quote("verdict-readings", len(groups))
    changed = [len({claim.verdict for claim in group.values()}) > 1 for group in groups]
    quote("verdict-readings-changed", sum(changed))


def _said() -> None:
    """What the lesson says in words about committed results."""
    stated("verdict-arms", _verdicts("verdicts-on-the-real-arm") == ["not reproduced"])
    real, nulls = _acceleration()
    stated("verdict-acceleration", resampled(real, np.mean) > max(nulls))
    stated("verdict-acceleration-other", nulls[1] == max(nulls) and nulls[1] > 0.25)
    stated("verdict-acceleration-all", start.beyond_unrelated().value < 0.05)
    shares = [start.shares_beside(*place, "velocity") for place in _places()]
    fewer = [x.pop("real").mean() < min(null.mean() for null in x.values()) for x in shares]
    stated("verdict-velocity", all(fewer))
    solver = _velocity_by_solver()
    stated("verdict-solver", solver["real"] > 3 * solver["phases"])
    spring = "position alone"
    stated("verdict-spring", planted.acceleration(spring) > 90)
    adds, own = (np.abs(planted.every(kind, "knob")) for kind in (spring, "the arm"))
    stated("verdict-knob", adds.max() < 0.05 and own.min() > 0.8)
    nulls = [planted.every(kind, "knob").max() for kind in ("shifted", "random phases")]
    stated("verdict-draws", max(nulls) > 0.6)
    stated("verdict-written", _verdicts("load-written") == ["reproduced"])
    shares = {place: start.shares_beside(*place, "acceleration") for place in _places()}
    own = {place: x["real"].mean() for place, x in shares.items()}
    most = all(own[reading, 0.03] > 0.6 for reading in SETUPS)
    stated("verdict-small-start", most and all(own[r, 0.3] < own[r, 0.03] for r in SETUPS))
    others = {place: max(x["shifted"].mean(), x["phases"].mean()) for place, x in shares.items()}
    stated("verdict-far-fewer", all(own[place] > 3 * others[place] for place in _places()))
    stated("verdict-inertia-beside", all(_beyond_all(*place) for place in _places()))
    inertia = _verdicts("conventional-filters-inertia-position-21")
    stated("verdict-inertia", inertia == ["reproduced"])
    rigid = _verdicts("unmodelled-error-real-arm")
    stated("verdict-friction", rigid == ["reproduced"])
    stated("verdict-tables", _verdicts("table-degrades", "vast-amount") == 2 * ["reproduced"])
    wider = _verdicts("training-falls", "training-falls-damping", "training-falls-position")
    stated("verdict-wider", wider == ["not reproduced", "reproduced", "not reproduced"])
    stated(
        "verdict-cube", _verdicts("entire-state-space", "generalised-well") == 2 * ["reproduced"]
    )
    stated("verdict-window", _verdicts("tradeoff") == ["undecided"])
    stated("verdict-behind", bool(window_size.behind_least_squares().any()))
    stated("verdict-memory", _verdicts("memorises") == ["not reproduced"])
    stated("verdict-memory-damped", claims.measured("memorises-damping").replicates > 1.02)
    stated("verdict-equations", over("identified").max() < 1)
    stated("verdict-linear", over("linear filter").min() < 1 < over("linear filter").max())
    stated("verdict-directed", over("linear filter with friction").max() < 1)
    stated("verdict-unsettled", _verdicts("weights-stable") == ["not reproduced"])


def sentences_figure() -> Illustration:
    """The first figure: how many sentences have which word, and one of them each."""
    sentences = of_kind("system")
    counts = tally(sentences)
    chosen = {}
    for word in counts:
        those = [card for card in sentences if card.verdict() == word]
        first = [card for card in those if card.id in _EXAMPLES]
        chosen[word] = typeset(([*first, *those] or [None])[0].says) if those else ""

    best, under = next(iter(by_reading(sentences).items()))

    def draw(figure: Figure):
        axis, wide = figure.subplots(), figure.get_figwidth() > NARROW
        places, most = range(len(counts)), max(*counts.values(), *under.values())
        high = 1.0 if wide else 0.5  # a narrow page has the sentences below the bars
        for place, (word, number), look in zip(places, counts.items(), _LOOKS):
            upper, lower = place - 0.16 * high, place + 0.2 * high
            axis.barh(upper, number, height=0.4 * high, **look)
            axis.barh(lower, under[word], height=0.18 * high, color=FAINT)
            axis.text(number + 0.4, upper, str(number), size=9, va="center", weight="bold")
            axis.text(under[word] + 0.4, lower, str(under[word]), size=8, va="center")
            wrapped = textwrap.fill(chosen[word], 50 if wide else 30)
            at = (1.3 * most, place) if wide else (0, place + 0.2)
            says = axis.text(*at, wrapped, size=9.5, va="center" if wide else "top")
            says.set_in_layout(False)
        axis.set_yticks(places, list(counts))
        axis.set_ylim(len(counts) - (0.5 if wide else 0.15), -0.4)
        axis.set_xlim(0, (5.4 if wide else 1.5) * most)
        axis.set_xticks([])
        axis.spines[["left", "bottom"]].set_visible(False)
        axis.tick_params(left=False)
        axis.grid(False)

    text = "; ".join(
        f"{n} {word}, {under[word]} with {best}, like: {chosen[word]}" for word, n in counts.items()
    )
    alt = f"Sentences of the report by verdict. {text}."
    return illustrate(draw, alt, 7.2, 2.6, narrow_height=4.8)


def _by_section() -> dict[str, dict[str, int]]:
    """How many sentences of each section of the paper have which word."""
    groups: dict[str, list] = {}
    for card in sorted(of_kind("system", "methods"), key=lambda card: card.deciding[0].place()):
        groups.setdefault(SECTIONS[card.deciding[0].place()[0]], []).append(card)
    return {section: tally(group) for section, group in groups.items()}


def planned_table() -> Table:
    """Rows of the ledger on what the report planned."""
    return _chosen(claim.id for claim in claims.of_the_paper() if claim.where == "section 7.1")


def summed_table(right: bool) -> Table:
    """Rows that the verdict sums up: what the report got right, or all others."""
    verdicts = zip(_SUMMED, _verdicts(*_SUMMED))
    return _chosen(row for row, verdict in verdicts if (verdict == "reproduced") == right)


def _chosen(ids: Iterable[str]) -> Table:
    """Some rows of the ledger: claim and its chapter, printed value, ours, verdict, reason."""
    known, rows = {claim.id: claim for claim in load()}, []
    for claim in (known[name] for name in ids):
        width, ours = window(claim), claim.our_value()
        pattern = rf"(window|at) {width}\b|\b{width} samples"
        if width and not re.search(pattern, f"{claim.claim} {ours}"):
            ours += f" (window {width})"
        sentence = f"{claim.claim} ({{doc}}`{home(claim)}`)"
        rows.append(
            (
                sentence,
                claim.as_printed(),
                ours,
                worded(claim, claim.verdict_with_share()),
                claim.why,
            )
        )
    header = ("claim", "printed", "here", "verdict", "why")
    return Table(header, [tuple(map(typeset, row)) for row in rows])


def sections_figure(counts: Mapping[str, Mapping[str, int]] | None = None) -> Illustration:
    """Sentences by section: one bar each below its title, a part for every word.

    A part has its number in it, unless it is too narrow to hold that.
    """
    counts = _by_section() if counts is None else counts
    names = list(next(iter(counts.values())))

    def draw(figure: Figure):
        axis = figure.subplots()
        starts = [0] * len(counts)
        places = range(len(counts))
        most = max(sum(row.values()) for row in counts.values())
        room = (72 * figure.get_figwidth() - 24) / (1.05 * most)  # points for each sentence
        for name, look in zip(names, _LOOKS):
            numbers = [row[name] for row in counts.values()]
            bars = axis.barh(places, numbers, left=starts, height=0.5, label=name, **look)
            fits = [number * room > _DIGIT * len(str(number)) + 1 for number in numbers]
            words = [str(number) if number and fit else "" for number, fit in zip(numbers, fits)]
            axis.bar_label(bars, words, label_type="center", color=INK, size=8.5)
            starts = [a + b for a, b in zip(starts, numbers)]
        for place, title in zip(places, counts):
            axis.text(0, place - 0.3, title, size=9, va="bottom")
        axis.set_yticks([])
        axis.set_ylim(len(counts) - 0.6, -0.85)
        axis.set_xlim(0, 1.05 * most)
        axis.spines["left"].set_visible(False)
        axis.set_xlabel("sentences")
        legend_above(figure, *axis.get_legend_handles_labels())

    rows = "; ".join(
        f"{section}: " + ", ".join(f"{number} {name}" for name, number in row.items() if number)
        for section, row in counts.items()
    )
    height = 1.3 + 0.46 * len(counts)
    return illustrate(draw, f"Sentences by section of the paper. {rows}.", 7.0, height)


def readings_table() -> Table:
    """Verdicts of sentences by reading: a row for each, those that agree last."""
    readings, rows = tuple(SETUPS), []
    for group in _by_reading(claims.of_the_paper()):
        first = min(group.values(), key=lambda claim: len(claim.claim))
        verdicts = [group[name].verdict if name in group else "–" for name in readings]
        same = len({claim.verdict for claim in group.values()}) == 1
        rows.append((same, (f"{first.claim} ({first.where})", *verdicts)))
    rows.sort(key=lambda row: row[0])
    return Table(("sentence", *readings), [tuple(map(typeset, row)) for _, row in rows])


def _expected_changes(sentences: Iterable[Claim]) -> tuple[int, float]:
    """How many decided verdicts rest on draws, and how many of them another draw would change."""
    decided = [claim for claim in sentences if claim.verdict != "undecided"]
    agree = [c.shares().get(c.verdict, 0.0) for c in decided if c.shares()]
    return len(agree), float(len(agree) - sum(agree))


def _by_reading(sentences: Iterable[Claim]) -> list[dict[str, Claim]]:
    """Sentences judged under two or more readings of section 4: claims by the reading's name."""
    groups: dict[tuple, dict[str, Claim]] = {}
    for claim in sentences:
        if claim.is_measured:
            key, setup = claim.key_and_setup()
            groups.setdefault(key, {})[setup] = claim
    return [group for group in groups.values() if len(group) > 1]


class _Agreement(NamedTuple):
    """How many pairs are alike, how many would be, shuffled, and how often as many are."""

    pairs: int
    same: int
    expected: float
    chance: float


def _agreement(pairs: Iterable[tuple[str, str]]) -> _Agreement:
    """Whether pairs of verdicts agree more often than shuffled ones."""
    pairs = list(pairs)
    first, second = np.array(pairs).T
    same, rng = int((first == second).sum()), np.random.default_rng(0)
    drawn = np.array([(first == rng.permutation(second)).sum() for _ in range(_SHUFFLES)])
    expected = sum((first == v).sum() * (second == v).sum() for v in set(first)) / len(pairs)
    return _Agreement(len(pairs), same, float(expected), float((drawn >= same).mean()))


def changed_by_reading() -> Measured:
    """Share of the sentences judged under several readings whose verdict is not the same in all."""
    groups = _by_reading(claims.of_the_paper())
    changed = sum(len({claim.verdict for claim in group.values()}) > 1 for group in groups)
    return Measured(changed / len(groups), f"{changed} of {len(groups)} sentences")


def carried_over(arm: str) -> Measured:
    """Chance that shuffled verdicts agree as often as those on two arms do."""
    agreement = _agreement(_pairs_on(arm))
    text = f"{agreement.same} of {agreement.pairs} alike, {agreement.expected:.1f} by chance"
    return Measured(agreement.chance, text)


def _pairs_on(arm: str) -> list[tuple[str, str]]:
    """Verdicts of sentences on the simulated arm and on another one, where both were tested."""
    pairs = [(first.verdict, again.verdict) for first, again in claims.judged_again(arm)]
    return [pair for pair in pairs if "not testable" not in pair]


def reproduced_share(reading: str = "every") -> Measured:
    """Share of the paper's sentences that are reproduced, under "every" reading or the "best"."""
    some = cards.of_kind("system", "methods")
    name, by_word = f"{reading} reading", cards.tally(some)
    if reading == "best":
        name, by_word = next(iter(cards.by_reading(some).items()))
    reproduced, total = by_word["reproduced"], sum(by_word.values())
    return Measured(reproduced / total, f"{reproduced} of {total}, {name}")


def _exercise(number: int, *given) -> Exercise:
    """An exercise of the lesson."""
    if number == 1:
        slips = [(27, "the sum over s² is twice the inertia."), (8, "the arm moves, too.")]
        return Exercise(
            "number",
            19,
            "all filters with these three sums answer such a motion alike.",
            slips,
            "Expand q(t + s); what is its third term?",
            unit="N m",
        )
    elif number == 2:
        rough = {n: np.abs(np.diff(x, axis=-2)).mean() for n, x in given[0].items()}
        reason = (
            "it has no more to do with the motion than noise has, and any smooth shape beats it."
        )
        return Exercise(
            "word",
            max(rough, key=rough.get),
            reason,
            [],
            "which of them could the motors not have made?",
            options=tuple(rough),
        )
    else:

        def parts(extents):
            if np.abs(extents).max() > 45:
                return False
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                left = given[0](tuple(extents))
            return left["equations"] < 0.15 and left["network"] > 1.5 * left["equations"]

        otherwise = "which combinations of shoulder and elbow did no motion show to the network?"
        return Exercise(
            "numbers", parts, "equations carry where a fit does not.", [], otherwise, count=2
        )


check = judging(_exercise)
