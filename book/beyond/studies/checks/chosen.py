"""Four joints, five motions, the draws of the study of joints: training that is chosen."""

from beyond.studies.loop import joints
from beyond.studies.loop.chain import chain
from beyond.studies.loop.runs._conditions import _chosen_decay
from ddlib.metrics import rmss
from workshop.report.code_hash import study


@study
def _joints_chosen() -> dict:
    """Errors by joint and over all; each motion left out in turn chooses decay and steps."""
    test, rows = joints.tested(chain(4)), {"chosen": [], "by joint": [], "test": []}
    for seed in range(1, 1 + joints._SEEDS):
        five = joints.sets(chain(4), 5, seed)
        decay, steps = _chosen_decay(five, seed)
        found = joints.solved(*five.pair, test.pair, seed=seed, decay=decay, steps=steps)
        rows["chosen"].append((decay, steps))
        rows["by joint"].append(
            rmss(found.model[0].torque(test.windows), test.torque, pooled=False)
        )
        rows["test"].append(float(found.history.test[-1, 0]))
    return rows
