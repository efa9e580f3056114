"""What a claim of the chapter *Hinton diagrams* measures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib.learning import TrainingSet, Weights, train_ensemble
from ddlib.setups import STATE_FEEDBACK
from ddlib.tables import scientific
from workshop.report import committed
from workshop.report.evidence.verdicts import Measured


def adjacency(width: int = 11, epochs: int = 100) -> Measured:
    """Change of trained weights, over the largest, when all windows' samples are shuffled alike."""
    data = TrainingSet.from_recording(committed.training(), width)
    order = np.random.default_rng(0).permutation(width)
    start = Weights.random(1, width, initial=STATE_FEEDBACK.initial)

    def trained(places):
        weights = replace(start, **{name: getattr(start, name)[..., places] for name in along})
        mixed = replace(data, x=data.x[..., places])
        return train_ensemble(weights, mixed, momentum=0.9, epochs=epochs, progress=False)[
            0
        ].weights

    along = ("hidden_weights", "direct_weights")
    plain, mixed, back = trained(np.arange(width)), trained(order), np.argsort(order)
    gaps = (np.abs(getattr(mixed, n)[..., back] - getattr(plain, n)).max() for n in along)
    relative = float(max(gaps) / plain.largest.max())
    return Measured(relative, f"the weights differ by {scientific(relative)} after {epochs} epochs")
