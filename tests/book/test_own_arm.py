"""The tutorial for an arm of one's own: open cells alone, other parameters, a file, the checks."""

import ast
import json
import re

import numpy as np
import pytest
from book_pages import ROOT, source
from nine_answers import Nine, wrong
from open_cells import exercises

from ddlib.dynamics import Arm, Link
from ddlib.logs import write_csv
from workshop.chapters import exercises as engine

CELLS = [
    ("".join(cell["source"]), cell["id"], cell["metadata"].get("tags", []))
    for cell in json.loads(source("book/use-it-on-your-arm").read_text(encoding="utf-8"))["cells"]
    if cell["cell_type"] == "code"
]
OPEN = {name: code for code, name, tags in CELLS if tags in ([], ["change-this"])}
EXAMPLE = ROOT / "book" / "data" / "example-arm.csv"
BIG = "simulated = Arm.from_links('b', Link(10, 0.5, 0.25, 0.2), Link(6, 0.5, 0.25, 0.12))"
CHANGES = {
    "as it stands": "",
    "another arm, window 15": f"{BIG}; kp, window, epochs = (400, 100), 15, 300",
    "PD gains, 6 hidden units": "kp, kd, hidden_units, epochs = (60, 20), (8, 2), 6, 300",
    "three motions, hung up": "hangs = True; "
    "simulated = Arm.from_links('v', upper_arm, forearm, 9.81); "
    "extents, window, epochs = [[40, 20], [20, 40], [30, 30]], 11, 300",
    "a file, arm not known": f"files, epochs = {str(EXAMPLE)!r}, 300",
    "a file, no networks": f"files, networks = {str(EXAMPLE)!r}, False",
}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """What the open cells leave behind after a change, in a folder without the book."""
    made = {}

    def once(change):
        if change not in made:
            made[change] = space = {"__name__": "__main__"}
            with pytest.MonkeyPatch.context() as patch:
                patch.chdir(tmp_path_factory.mktemp("elsewhere"))
                for name, code in OPEN.items():
                    added = f"\n{CHANGES[change]}" * (name == "use-change")
                    exec(compile(code + added, name, "exec"), space)
        return made[change]

    return once


def test_open_cells_import_the_package_and_what_it_needs():
    nodes = [node for code in OPEN.values() for node in ast.walk(ast.parse(code))]
    found = {n.module.partition(".")[0] for n in nodes if isinstance(n, ast.ImportFrom)}
    found |= {name.name for n in nodes if isinstance(n, ast.Import) for name in n.names}
    assert found == {"control", "dataclasses", "ddlib", "numpy", "scipy", "warnings"}
    assert "use-change" in OPEN and len(OPEN) > 12


@pytest.mark.parametrize("change", CHANGES)
def test_other_parameters_go_through_to_the_last_figure(change, run):
    space = run(change)
    own, linear = space["own"], space["gains"](space["linear"], space["step"])
    assert np.isfinite(space["in_null"]).all()
    if space["networks"]:
        assert np.isfinite(space["shares"]).all() and len(space["in_null"]) == 3
    assert space["linear"].shape == (2, 2, space["window"])
    assert space["rmss"](space["rows"](space["x_test"]) @ space["fit"], space["torque_test"]) < 0.5
    if change.startswith("a file"):
        own = run("as it stands")["own"]
        assert np.isnan(space["own"]).all() and space["arm"] is None
    np.testing.assert_allclose(linear[0, 0, 2], own[0, 0, 2], rtol=0.25)


@pytest.mark.parametrize("change", [c for c in CHANGES if not c.startswith("a file")])
def test_the_equations_find_the_arm_and_fit_the_test_run(change, run):
    space = run(change)
    estimate, truth = space["estimate"], space["truth"]
    assert (np.abs(estimate.values - truth) < np.maximum(2 * estimate.half_width(), 0.02)).all()
    assert space["rmss"](space["asked"], space["measured"]) < 0.15


def test_one_slip_of_an_encoder_spoils_the_inertia_and_is_found(run):
    space = run("as it stands")
    fit = space["least_squares"](space["by_modulation"](space["spoilt"], space["names"]))
    assert not abs(fit.values[0] / space["truth"][0] - 1) < 0.1  # NaN: it cannot be told
    (wrong,) = space["check_recording"](space["spoilt"]).wrong
    assert (wrong.kind, wrong.run, wrong.joint) == ("spike", 0, 1)
    assert not space["check_recording"](space["training"]).wrong


def test_the_example_is_what_the_page_writes(run, tmp_path):
    space = run("as it stands")
    write_csv(tmp_path / "again.csv", space["recording"][:3])
    new, kept = (
        np.loadtxt(p, delimiter=",", skiprows=1) for p in (tmp_path / "again.csv", EXAMPLE)
    )
    np.testing.assert_allclose(new, kept, rtol=1e-3, atol=1e-4)


def test_a_window_of_a_fifth_of_a_second_is_what_networks_need_at_4_ms(run):
    """In as many epochs the book's 21 samples miss most of the torque there."""
    space = run("as it stands")
    law, rest = space["pd"](space["kp"], space["kd"]), {"effects": space["effects"]}
    log = space["record"](space["arm"], law, space["extents"], log_step=0.004, **rest)
    error = {}
    for width in (21, 51):
        data = space["TrainingSet"].from_recording(log[:-1], width, scaling=(-1, 1))
        start = space["Weights"].random(members=1, width=width, hidden=space["hidden_units"])
        model, *_ = space["train_ensemble"](start, data, **space["how"] | {"epochs": 1000})
        x, torque = space["cases"](log[-1:], width)
        error[width] = space["rmss"](model[0].torque(x), torque)
    assert error[51] < 0.1 and error[21] > 5 * error[51]


def test_the_feedforward_is_the_arm_with_its_friction(run):
    space = run("three motions, hung up")
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-1, 1, (3, 50, 2))
    v = np.where(np.abs(v) < 0.1, 0.2, v)  # dry friction is smooth only near rest
    truth = dict(zip(space["names"], space["truth"]))
    space["p"].update(truth)
    arm, effects = space["simulated"], space["effects"]
    wanted = arm.inverse_dynamics(q, v, a) + effects.friction_torque(v)
    np.testing.assert_allclose(space["feedforward"](q, v, a), wanted, rtol=1e-3, atol=1e-4)


def test_the_printed_c_is_the_same_function(run):
    """Its statements without types and semicolons are Python, too."""
    space = run("as it stands")
    body = space["in_c"](space["p"]).partition("double tau[2]) {")[2].rpartition("}")[0]
    body = re.sub(r"\s+", " ", body)
    lines = [re.sub("^ *double ", "", line).replace(", s =", "; s =") for line in body.split(";")]
    rng = np.random.default_rng(1)
    for q, v, a in rng.uniform(-2, 2, (20, 3, 2)):
        tau = [0.0, 0.0]
        names = {"q": q, "v": v, "a": a, "tau": tau}
        functions = {"cos": np.cos, "sin": np.sin, "tanh": np.tanh}
        exec("\n".join(line.strip() for line in lines), functions, names)
        np.testing.assert_allclose(tau, space["feedforward"](q, v, a), rtol=1e-4, atol=1e-6)


def test_the_feedforward_brings_the_tracking_error_down(run):
    alone, with_it = (np.array(row[1:], float) for row in run("as it stands")["tracking"])
    assert (with_it < alone / 3).all()
    alone, with_it = (np.array(row[1:], float) for row in run("another arm, window 15")["tracking"])
    assert (with_it < alone / 3).all()


def _log(path, runs, held=None, rate=100, seconds=6, weight=0.0, zero=0.0):
    """A log of an arm with sines in its joints, or with an elbow that is held at an angle."""
    links = Link(4.0, 0.35, 0.16, 0.05), Link(2.5, 0.3, 0.14, 0.025)
    arm = Arm.from_links("x", *links, weight)
    rng, t = np.random.default_rng(6), np.arange(seconds * rate) / rate
    lines = ["run;stamp;s;e;ampere s;ampere e"]
    for run in range(runs):
        turn = np.array([[2.0, 3.0, 7.0], [2.6, 3.7, 8.0]]).T[:, None]
        angle = turn * t[:, None] + rng.uniform(0, 6, (3, 1, 2))
        size = np.array([0.5, 0.4, 0.05])[:, None, None] * [1.0, held is None]
        q, v = (size * np.sin(angle)).sum(0), (size * turn * np.cos(angle)).sum(0)
        tau = arm.inverse_dynamics(
            q + np.array([0, held or 0]), v, -(size * turn**2 * np.sin(angle)).sum(0)
        )
        tau = (tau + [0.4, 0.2] * v + rng.normal(0, 0.01, q.shape)) / [0.5, 0.25]
        q = np.rad2deg(q + [0, held or 0] + (held is None) * rng.normal(0, 1e-5, q.shape))
        q += [zero, 0]
        for row in np.column_stack([t, q, tau]):
            lines.append(f"{run};" + ";".join(f"{x:.6f}".replace(".", ",") for x in row))
    path.write_text("\n".join(lines))
    heads = {"time": "stamp", "q1": "s", "q2": "e", "tau1": "ampere s", "tau2": "ampere e"}
    units, factors = {"q": "deg", "tau": "A"}, {"tau1": 0.5, "tau2": 0.25}
    return (
        f"files, columns, units, factors = {str(path)!r}, {heads!r}, {units!r}, {factors!r}"
    ), arm


def _until(cell, change):
    """What the open cells leave behind down to one of them."""
    space = {"__name__": "__main__"}
    for name, code in OPEN.items():
        exec(compile(code + f"\n{change}" * (name == "use-change"), name, "exec"), space)
        if name == cell:
            return space


def test_one_long_run_in_degrees_and_amperes_is_cut_and_identified(tmp_path, capsys):
    change, arm = _log(tmp_path / "long.csv", 1, rate=1000, seconds=20)
    with pytest.raises(ValueError, match="cut a long one by seconds"):
        _until("use-record", change)
    space = _until("use-residual-code", f"{change}; seconds = 5; step = 0.01")
    assert len(space["recording"].q) == 4 and not space["untold"]
    found = space["estimate"].values[:3]
    np.testing.assert_allclose(found, [arm.a, arm.b, arm.d], rtol=0.02)
    assert space["left"] < 0.2 and "do not describe" not in capsys.readouterr().out


def test_a_held_elbow_is_said_and_not_guessed(tmp_path, capsys):
    change, _ = _log(tmp_path / "held.csv", 3, held=0.3)
    space = _until("use-residual-code", change)
    table, told = space["estimate"], capsys.readouterr().out
    assert {"a", "b", "d"} <= set(space["untold"])
    assert np.isnan(table.values[:3]).all() and "a + 1.91 b = " in told
    assert "counts as 0 what the log cannot tell: a, b, d" in told
    assert "Do not drive it by them." in told
    with pytest.raises(ValueError, match="a joint that stands still"):
        _until("use-train", change)
    space = _until([*OPEN][-1], f"{change}; networks = False")  # no cell below fails
    told = capsys.readouterr().out
    assert "cannot tell, here 0: a, b, d" in told and "No arm has these numbers" in told


def test_a_hanging_arm_in_degrees_and_amperes_by_alphabet_is_mended_by_messages(tmp_path):
    change, arm = _log(tmp_path / "ros.csv", 3, weight=9.81, zero=90.0)
    change = change.replace("'q1': 's', 'q2': 'e'", "'q1': 'e', 'q2': 's'")
    change = change.replace("'ampere s'", "'x'").replace("'ampere e'", "'ampere s'")
    change = change.replace("'x'", "'ampere e'").replace("0.5, 'tau2': 0.25", "0.25, 'tau2': 0.5")

    def told(change):
        space = _until("use-check-log", change)
        return {f.kind: f.advice for f in space["check_recording"](
            space["recording"], space["names"]).wrong}  # fmt: skip

    assert "order of the joints" in told(change)
    right = change.replace("'q1': 'e', 'q2': 's'", "'q1': 's', 'q2': 'e'")
    right = right.replace("'ampere e'", "'x'").replace("'ampere s'", "'ampere e'")
    right = right.replace("'x'", "'ampere s'").replace("0.25, 'tau2': 0.5", "0.5, 'tau2': 0.25")
    assert "GRAVITY" in told(right)["gravity"]
    right += "; hangs = True"
    angle = float(told(right)["zero of the shoulder"].split("Add ")[1].split("°")[0])
    assert angle == pytest.approx(-90, abs=1)
    right += f"; zeros = ({angle}, 0)"
    assert not told(right)
    found = _until("use-estimate", right)["estimate"].values
    wanted = [arm.a, arm.b, arm.d, *arm.gravity_moments]
    np.testing.assert_allclose(found[[0, 1, 2, -2, -1]], wanted, rtol=0.03)


def test_the_step_shows_windup_and_margins_are_kept(run):
    space = run("as it stands")
    phases = np.array([float(row[2]) for row in space["table_of_margins"]])
    assert (phases > 45).all()
    waits, goes_on = (space["steps"][name] for name in ("integral waits", "integral goes on"))
    assert (waits.max(0) - 40 < 0.3 * (goes_on.max(0) - 40)).all()


EXERCISES = exercises("book/use-it-on-your-arm")


def test_checks_take_nine_kinds_of_answers(run, monkeypatch):
    space = dict(run("as it stands"))
    assert len(EXERCISES) == 3
    for exercise in EXERCISES:
        nine = Nine(space, *exercise)
        monkeypatch.setattr(engine, "judge", nine.judge)
        assert not wrong(nine), exercise.check
