"""The foreign machines: each really differs from this one."""

import subprocess
import sys

import foreign_machines as foreign

DRAWS = """
import numpy as np
rng = np.random.default_rng(np.random.SeedSequence(3))
assert isinstance(rng, np.random.Generator) and rng.spawn(1)[0].random() < 1
draws = [rng.uniform(-1, 1, 3), rng.normal(2.0, 1.0, 3), rng.standard_normal(3), rng.random(3)]
print(*np.concatenate(draws).tolist(), rng.integers(0, 100), rng.permutation(9).tolist())
"""


def test_jogs_multiply_every_real_draw_and_leave_integers(tmp_path):
    env, command = foreign.environment("jog-7", tmp_path), [sys.executable, "-c", DRAWS]
    plain, jogged = (
        subprocess.run(command, env={**env, "DDLIB_JOG": jog}, capture_output=True, text=True)
        for jog in ("", env["DDLIB_JOG"])
    )
    assert not plain.stderr + jogged.stderr
    plain, jogged = plain.stdout.split(), jogged.stdout.split()
    assert [float(x) for x in jogged[:12]] == [float(x) * (1 + 7e-9) for x in plain[:12]]
    assert jogged[12:] == plain[12:]
