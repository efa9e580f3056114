"""Data of others: unchanged files, whose loaders tell what their page says."""

import hashlib

import numpy as np

from beyond import others

PAGE = (others.DATA / "README.md").read_text(encoding="utf-8")


def test_files_are_as_they_came():
    for name, licence, digest in (
        ("characters", "", "482a697e1bf620e12763255cd067cfdcb84257dfc58b8d048cfa46872f7628c9"),
        ("staubli-tx40", "", "665c1c7ba945f08339efa795e4fd5a47fd855b3e3d676aaeea21699f777558f7"),
        ("delan-published", "characters",
         "558d09312ec245c3e519c7a797073c16b8b1f735f9c3d03ff0376041df080945"),
        ("double-pendulum", "",
         "ca25bc20dab0db3d1dff5c054c57fa733983d2a26b70a9dab292096331413d18"),
        ("kr300", "", "c144205a063d2ed721e911e2c716f06926e56dbc2b99ae61c8092c1404d3d0f9"),
    ):  # fmt: skip
        content = (others.DATA / f"{name}.npz").read_bytes()
        assert hashlib.sha256(content).hexdigest() == digest
        assert digest in PAGE and f"LICENSE-{licence or name}" in PAGE
        assert (others.DATA / f"LICENSE-{licence or name}").stat().st_size > 500


def test_characters_are_sampled_evenly():
    found = others.read_characters()
    assert len(found) == 20 and found.length.sum() == len(found.t) == 2913
    begins = np.cumsum(found.length)[:-1]
    steps = np.delete(np.diff(found.t), begins - 1)
    np.testing.assert_allclose(steps, found.STEP, atol=1e-9)
