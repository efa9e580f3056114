"""Networks on their way to PyTorch and back, against the same sums in numpy."""

import io

import numpy as np
import pytest
import torch
from torch import nn

from ddlib.analysis import gains, mean_gradient, savitzky_golay
from ddlib.learning import Scaler, TorqueModel, Weights

RNG = np.random.default_rng(7)
STEP = 0.004
WINDOWS = RNG.uniform(-1, 1, (60, 2, 11))


def model(lead=()):
    shapes = {
        "hidden_weights": (*lead, 5, 2, 11),
        "hidden_bias": (*lead, 5),
        "output_weights": (*lead, 2, 5),
        "direct_weights": (*lead, 2, 2, 11),
        "output_bias": (*lead, 2),
    }
    weights = Weights(**{name: RNG.normal(0, 0.3, shape) for name, shape in shapes.items()})
    inputs, outputs = Scaler([-1, -2], [1.5, 2], (-1, 1)), Scaler([-8, -3], [9, 4], (0.2, 0.8))
    return TorqueModel(weights, inputs, outputs, STEP)


@pytest.mark.parametrize("lead", [(), (3,), (2, 3)])
def test_a_module_gives_the_models_torques(lead):
    own = model(lead)
    module = own.module()
    assert isinstance(module, nn.Module)
    torque = module(torch.tensor(WINDOWS)).detach().numpy()
    np.testing.assert_allclose(torque, own.torque(WINDOWS), rtol=1e-12, atol=1e-12)
    assert module(torch.tensor(WINDOWS).reshape(3, 20, 2, 11)).shape == (*lead, 3, 20, 2)
    single = module.float()(torch.tensor(WINDOWS, dtype=torch.float32))
    assert single.dtype == torch.float32
    np.testing.assert_allclose(single.detach(), own.torque(WINDOWS), atol=1e-4)


def test_an_exported_program_gives_the_same_torques():
    own, file = model(), io.BytesIO()
    module, x = own.module(), torch.tensor(WINDOWS)
    program = torch.export.export(
        module, (x[:2],), dynamic_shapes=({0: torch.export.Dim("cases", min=1)},)
    )
    torch.export.save(program, file)
    file.seek(0)
    found = torch.export.load(file).module()(x).detach()
    np.testing.assert_allclose(found, own.torque(WINDOWS), rtol=1e-12)


@pytest.mark.parametrize("lead", [(), (3,)])
def test_gradients_of_a_module_and_of_a_function_are_those_of_the_model(lead):
    own = model(lead)
    wanted = mean_gradient(own, WINDOWS)
    np.testing.assert_allclose(mean_gradient(own.module(), WINDOWS), wanted, rtol=1e-10)
    by_steps = mean_gradient(own.torque, WINDOWS)
    np.testing.assert_allclose(by_steps, wanted, rtol=1e-6, atol=1e-8)
    rough = mean_gradient(lambda x: own.torque(x).astype(np.float32), WINDOWS)
    np.testing.assert_allclose(rough, wanted, atol=2e-3 * np.abs(wanted).max())


class Filtered(nn.Module):
    """Torques of a point mass on a spring, by a convolution: M qdd + K q, with known M and K."""

    def __init__(self, mass, stiffness):
        super().__init__()
        taps = mass * savitzky_golay(11, 2, STEP) + stiffness * savitzky_golay(11, 0, STEP)
        self.convolution = nn.Conv1d(2, 2, 11, groups=2, bias=False, dtype=torch.float64)
        self.convolution.weight.data[:] = torch.tensor(taps)[:, None]
        self.dropout = nn.Dropout(0.5)

    def forward(self, x):
        return self.dropout(self.convolution(x).squeeze(-1))


def test_the_inertia_of_a_convolution_is_the_one_it_was_given():
    mass, stiffness = np.array([[1.7], [0.4]]), np.array([[3.0], [9.0]])
    module = Filtered(mass, stiffness)
    found = gains(mean_gradient(module, WINDOWS), STEP)
    assert module.training and module.dropout.training  # as it was before
    np.testing.assert_allclose(found[..., 2], np.diag(mass[:, 0]), atol=1e-9)
    np.testing.assert_allclose(found[..., 0], np.diag(stiffness[:, 0]), atol=1e-9)
