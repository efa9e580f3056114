"""Data that several modules train networks on."""

import warnings

import pytest
from small_networks import smooth_cases

from ddlib.learning import TrainingSet, WorseThanMean


@pytest.fixture(scope="session")
def data():
    return TrainingSet.from_arrays(*smooth_cases())


@pytest.fixture(scope="session")
def other(data):
    return data.transform(*smooth_cases(50, seed=1))


@pytest.fixture(autouse=True)
def short_runs_may_end_anywhere():
    """Some runs are too short to get below a guess of the mean."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WorseThanMean)
        yield
