"""The pick-and-place family against its formula, its derivatives and Appendix I."""

import json
import warnings
from pathlib import Path

import nbclient
import nbformat
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from jupyter_client.manager import start_new_kernel

from ddlib import trajectories
from ddlib.trajectories import (
    APPENDIX_I,
    KEPT_IN,
    OutsideFamilyWarning,
    keep,
    pick_and_place,
    picked,
    random_extents,
    smooth_pick_and_place,
    time_grid,
)

family = st.tuples(st.floats(0, 45), st.floats(0, 45))


@settings(deadline=None, max_examples=30)
@given(extents=family)
def test_velocity_and_acceleration_are_derivatives(extents):
    t, h = np.linspace(0.01, 2.99, 150), 1e-3
    at = pick_and_place(extents, t)
    near = {k: pick_and_place(extents, t + k * h) for k in (-2, -1, 1, 2)}

    def slope(field):
        x = {k: getattr(value, field) for k, value in near.items()}
        return (8 * (x[1] - x[-1]) - (x[2] - x[-2])) / (12 * h)

    np.testing.assert_allclose(slope("q"), at.qd, atol=1e-9)
    np.testing.assert_allclose(slope("qd"), at.qdd, atol=1e-9)


@settings(deadline=None, max_examples=30)
@given(extents=family)
def test_out_to_the_extent_and_back(extents):
    q, qd, qdd = pick_and_place(extents, np.array([0.0, 0.75, 1.5, 2.25]))
    theta = np.deg2rad(extents)
    np.testing.assert_allclose(q, -theta * np.sqrt([[0], [0.5], [1], [0.5]]), atol=1e-15)
    np.testing.assert_allclose(qd[2], 0, atol=1e-15)  # turns at the extent
    np.testing.assert_allclose(qd[0], -theta * np.pi / 3)
    np.testing.assert_allclose(qdd, -((np.pi / 3) ** 2) * q, atol=1e-15)  # a harmonic motion
    with warnings.catch_warnings():
        warnings.simplefilter("error", OutsideFamilyWarning)
        fine = pick_and_place(extents, np.linspace(0, 3, 3001)).q
    np.testing.assert_allclose(np.abs(fine).max(0), theta, atol=1e-15)
    np.testing.assert_allclose(fine[1:3000], fine[2999:0:-1], atol=1e-12)  # back as it went out
    assert (fine <= 0).all() and (qdd >= 0).all()  # the minus sign of Appendix I


def test_velocity_jumps_at_both_ends():
    moment = 1e-9
    t = np.array([-moment, 0.0, 3.0 - moment, 3.0])
    qd = pick_and_place([45.0, 45.0], t).qd[:, 0]
    np.testing.assert_allclose(qd, [0.0, -0.8225, 0.8225, 0.0], atol=5e-5)


@pytest.mark.parametrize("extents", [(45.1, 0), (0, -0.1), (90, 90), [[1, 2], [3, 46]]])
def test_extents_outside_the_family_warn_and_still_work(extents):
    with pytest.warns(OutsideFamilyWarning, match="0 to 45") as caught:
        q = pick_and_place(extents, [1.5]).q
    np.testing.assert_allclose(q[..., 0, :], -np.deg2rad(extents))
    assert caught[0].filename == __file__  # points at the caller


RADIANS = "if they are radians"


@pytest.mark.parametrize("make", [pick_and_place, smooth_pick_and_place])
@pytest.mark.parametrize("extents", [np.deg2rad([45.0, 30.0]), [(0.8, 0.0), (0.1, 1.5)]])
def test_extents_that_look_like_radians_warn_once(make, extents):
    with pytest.warns(UserWarning, match=RADIANS) as caught:
        make(extents, [1.5])
    assert len(caught) == 1 and caught[0].filename == __file__


@pytest.mark.parametrize("make", [pick_and_place, smooth_pick_and_place])
@pytest.mark.parametrize(
    "extents", [(5.0, 0.0), (1, 2), (0.0, 0.0), (5.4, 0.3), [(0.5, 0), (20, 0)]]
)
def test_small_extents_in_degrees_do_not(make, extents):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        make(extents, [1.5])


def test_random_extents_fill_the_square():
    extents = random_extents(20_000, seed=3)
    assert extents.shape == (20_000, 2) and extents.min() >= 0 and extents.max() <= 45
    np.testing.assert_allclose(extents.mean(0), 22.5, atol=4 * 13 / np.sqrt(20_000))
    np.testing.assert_allclose(extents.std(0), 45 / np.sqrt(12), rtol=0.02)
    assert abs(np.corrcoef(extents.T)[0, 1]) < 4 / np.sqrt(20_000)  # each joint independently


@pytest.mark.parametrize("duration", [0.7, 2.3, 2.5, 6.0])
def test_a_motion_of_any_duration_is_the_papers_in_other_time(duration):
    t = np.linspace(-0.5, 1.5, 81)
    q, qd, qdd = pick_and_place([[45.0, 20.0], [3.0, 0.0]], duration * t, duration)
    usual = pick_and_place([[45.0, 20.0], [3.0, 0.0]], 3 * t)
    np.testing.assert_allclose(q, usual.q, atol=1e-14)
    np.testing.assert_allclose(qd, usual.qd * 3 / duration, atol=1e-13)
    np.testing.assert_allclose(qdd, usual.qdd * (3 / duration) ** 2, atol=1e-12)


@settings(deadline=None, max_examples=200)
@given(
    samples=st.integers(1, 5000),
    rest=st.integers(1, 50),
    duration=st.floats(0.01, 100) | st.just(3.0),
)
def test_a_grid_of_any_duration_holds_the_motion_and_no_sample_more(samples, rest, duration):
    """The end itself belongs to the rest, whatever the step rounds to."""
    step = duration / samples
    t = time_grid(step, rest * step, duration)
    assert (t == 0).sum() == (t == duration).sum() == 1
    moving = pick_and_place((10.0, 20.0), t, duration).qdd.any(-1)
    assert moving.sum() == samples - 1  # at 0 s the sine is zero
    np.testing.assert_array_equal(np.flatnonzero(moving), rest + np.arange(1, samples))


OWN = [[10.0, 20.5], [30.0, 5.0], [44.0, 44.0], [0.0, 12.0]]


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """Someone who runs cells in a folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(trajectories, "_someone_is_there", lambda: True)


def test_extents_that_a_reader_keeps_are_found_until_appendix_i_takes_their_place(reader, capsys):
    assert picked() is APPENDIX_I and not capsys.readouterr().out
    keep(OWN)
    assert "4 motions" in capsys.readouterr().out
    np.testing.assert_array_equal(picked(), OWN)
    assert len(capsys.readouterr().out.splitlines()) == 1
    keep(APPENDIX_I.tolist())
    assert picked() is APPENDIX_I and not Path(KEPT_IN).exists()


@pytest.mark.parametrize("wrong", [OWN[:3], [[46.0, 0.0], *OWN], [[-1.0, 0.0], *OWN], [1.0, 2.0]])
def test_extents_that_lessons_could_not_use_are_not_kept(reader, wrong):
    keep(OWN)
    with pytest.raises(ValueError, match="extents_deg must"):
        keep(wrong)
    np.testing.assert_array_equal(picked(), OWN)


@pytest.mark.parametrize("text", ["", "[[1, 2", '{"a": 1}', "[[1, 2]]", '[["a", "b"]]', "\udcff"])
def test_a_file_that_holds_none_is_told(reader, capsys, text):
    Path(KEPT_IN).write_bytes(text.encode("utf-8", "surrogateescape"))
    assert picked() is APPENDIX_I
    assert KEPT_IN in capsys.readouterr().out


def test_where_nobody_is_a_file_is_neither_read_nor_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path(KEPT_IN).write_text(json.dumps(OWN))
    keep(APPENDIX_I)
    assert picked() is APPENDIX_I and Path(KEPT_IN).exists()
    code = "from ddlib.trajectories import keep, picked\nkeep(picked() / 2)\nprint(len(picked()))"
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
    nbclient.NotebookClient(notebook, resources={"metadata": {"path": str(tmp_path)}}).execute()
    (output,) = notebook.cells[0].outputs  # as a build and a test run it
    assert output.text.startswith("Not kept") and output.text.endswith("\n6\n")
    assert json.loads(Path(KEPT_IN).read_text()) == OWN
    manager, client = start_new_kernel(cwd=str(tmp_path))
    try:
        told = []
        ask = {"allow_stdin": True, "output_hook": lambda message: told.append(message["content"])}
        client.execute_interactive(code, **ask, timeout=60)  # as JupyterLab asks for it
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)
    text = "".join(content.get("text", "") for content in told)
    assert "Your own 4 motions" in text and "Kept" in text and text.endswith("\n4\n")
    np.testing.assert_allclose(json.loads(Path(KEPT_IN).read_text()), np.array(OWN) / 2)
