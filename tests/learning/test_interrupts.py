"""Ctrl-C ends a training within a second, and what was reached is kept."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

CALLS = {
    "descent": "train_ensemble(start, data, test=test, epochs=10**7, snapshots=(0, 1), **quiet)",
    "solve": "solve(start, data, test=test, steps=10**7, tolerance=0.0, **quiet)",
}
SCRIPT = """
import json, signal, sys, threading, time, warnings
import numpy as np
signal.signal(signal.SIGINT, signal.default_int_handler)  # what a shell runs aside ignores it
from ddlib import STATE_FEEDBACK, TrainingSet, Weights, cases, rmss, solve, split, train_ensemble
from ddlib.learning import TrainingInterrupted

training, run = split(STATE_FEEDBACK.record())
data, quiet = TrainingSet.from_recording(training, 21), dict(progress=False)
test = data.transform(*cases(run, 21))
start = Weights.random({members}, 21)
try:
    threading.Timer(0.0, lambda: print("begun", flush=True)).start()
    {call}
except TrainingInterrupted as stop:
    ended = time.time()
    windows, torque = cases(training, 21)
    print(json.dumps(dict(
        ended=ended, words=str(stop), epochs=stop.epochs.tolist(),
        members=len(stop.model.weights), moved=np.abs(
            stop.model.weights.hidden_weights - start.hidden_weights).max((1, 2, 3)).tolist(),
        told=stop.history.training[-1].tolist(), tested=stop.history.test[-1].tolist(),
        last=int(stop.history.epochs[-1]), snapshots=sorted(stop.snapshots),
        right=rmss(stop.model.torque(windows), torque).tolist(),
        busy=sum("Pool" in t.name for t in threading.enumerate()),
    )))
"""


@pytest.mark.parametrize("call", CALLS)
def test_ctrl_c_hands_out_what_was_reached(call):
    script = SCRIPT.format(call=CALLS[call], members=20)
    process = subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout.readline() == "begun\n"
        time.sleep(1.5)
        asked = time.time()
        os.kill(process.pid, signal.SIGINT)
        out, error = process.communicate(timeout=60)
    finally:
        process.kill()  # a training that heard nothing would go on for days
    assert error == "" and process.returncode == 0
    found = json.loads(out)
    assert found["ended"] - asked < 1.0
    assert found["busy"] == 0 and found["members"] == 20
    epochs = np.array(found["epochs"])
    begun = epochs > 0
    assert begun[0] and (epochs < 10**7).all() and found["last"] == epochs.max()
    assert not begun.all()  # some were waiting for a thread
    np.testing.assert_array_equal(np.array(found["moved"]) > 0, begun)
    errors = np.array(found["told"])[begun]  # those of the model that is handed out
    np.testing.assert_allclose(errors, np.array(found["right"])[begun], rtol=1e-4)
    assert np.isfinite(np.array(found["tested"])[begun]).all()
    assert f"{epochs.max():,} of 10,000,000" in found["words"] and len(found["words"]) < 300
    assert found["snapshots"] == ([0] if call == "descent" else [])
