"""Directions of windows and how fast they are learnt, against descent and autograd."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, strategies as st
from small_networks import WIDTH, parts

from ddlib.learning import (
    Directions,
    Lazy,
    Weights,
    WindowNetwork,
    effective_steps,
    jacobian,
    with_ones,
)

INPUTS = 2 * WIDTH + 1


@pytest.fixture(scope="module")
def few(data):
    """Six cases, fewer than inputs: their span leaves most directions out."""
    return replace(data, x=data.x[::13][:6], y=data.y[::13][:6])


def start(seed=3, hidden=4):
    return Weights.random(1, WIDTH, hidden, seed=seed)[0]


def module(weights):
    """The same network in PyTorch, in double precision."""
    net = WindowNetwork(WIDTH, len(weights.hidden_bias)).double()
    with torch.no_grad():
        for parameter, array in zip(net.parameters(), parts(weights)):
            parameter.copy_(torch.from_numpy(array))
    return net


def descend(weights, data, eps, momentum, epochs):
    """Batch descent with momentum by autograd in double precision."""
    net = module(weights)
    optimiser = torch.optim.SGD(net.parameters(), lr=eps, momentum=momentum)
    x, y = torch.from_numpy(data.x), torch.from_numpy(data.y)
    for _ in range(epochs):
        optimiser.zero_grad()
        (0.5 * (net(x) - y).square().sum()).backward()
        optimiser.step()
    return net.weights()


def outside(change, x):
    """Length of what no combination of the rows of x gives, over the whole length."""
    left = change - (np.linalg.lstsq(x.T, change.T, rcond=None)[0].T @ x)
    return np.linalg.norm(left) / np.linalg.norm(change)


# --- the theorem --------------------------------------------------------------------------


@pytest.mark.parametrize("momentum, epochs", [(0.0, 1), (0.9, 50)])
def test_updates_lie_in_the_span_of_the_windows(few, momentum, epochs):
    begun = start()
    change = descend(begun, few, 0.1, momentum, epochs).rows - begun.rows
    x = with_ones(few.x)
    assert np.linalg.matrix_rank(x) == 6 < INPUTS
    assert outside(change, x) < 1e-13
    everything = np.random.default_rng(0).normal(size=change.shape)
    assert outside(everything, x) > 0.5  # what descent might have done, but cannot


def test_a_change_is_singular_value_times_accumulated_error(data):
    """The sum of back-propagated errors with momentum, by our own numpy, against the weights."""
    along, begun, eps, alpha = Directions.of(data), start(), 0.02, 0.8
    x, h = with_ones(data.x), len(begun.hidden_bias)
    w, second = begun.rows.copy(), begun.output_weights.copy()
    step, step_second, memory, total = 0 * w, 0 * second, 0, 0
    for _ in range(40):
        hidden = 1 / (1 + np.exp(-x @ w[:h].T))
        output = 1 / (1 + np.exp(-x @ w[h:].T - hidden @ second.T))
        delta = (output - data.y) * output * (1 - output)
        back = np.column_stack([delta @ second * hidden * (1 - hidden), delta])
        memory = alpha * memory + back
        total = total + memory
        step = alpha * step - eps * back.T @ x
        step_second = alpha * step_second - eps * (delta.T @ hidden)
        w, second = w + step, second + step_second
    trained = descend(begun, data, eps, alpha, 40)
    np.testing.assert_allclose(trained.rows, w, atol=1e-12)
    expected = -eps * along.values * (along.cases.T @ total).T
    np.testing.assert_allclose(along.along(trained) - along.along(begun), expected, atol=1e-12)


# --- the recursion ------------------------------------------------------------------------


@given(
    rates=st.lists(st.floats(0, 2.9), min_size=1, max_size=5),
    momentum=st.floats(0.5, 0.95),
    warm_up=st.integers(0, 30),
)
def test_recursion_is_descent_epoch_by_epoch(rates, momentum, warm_up):
    q = effective_steps(rates, range(60), momentum, warm_up)
    p, step = np.zeros(len(rates)), np.zeros(len(rates))
    for epoch in range(60):
        np.testing.assert_allclose(q[epoch], -p, rtol=1e-7, atol=1e-7)
        alpha = min(momentum, 0.5) if epoch < warm_up else momentum
        step = alpha * step - (1 + np.array(rates) * p)
        p = p + step


# --- the linearised network ---------------------------------------------------------------


def test_jacobian_is_that_of_autograd(data):
    weights, x = start(), torch.from_numpy(data.x)
    net = module(weights)
    names = [name for name, _ in net.named_parameters()]

    def run(*arrays):
        return torch.func.functional_call(net, dict(zip(names, arrays)), (x,))

    slopes = torch.autograd.functional.jacobian(run, tuple(net.parameters()))
    exact = dict(zip(names, (d.detach().numpy() for d in slopes)))
    cases = len(data.x), 2
    into = [
        np.concatenate([exact[w].reshape(*cases, n, -1), exact[b].reshape(*cases, n, 1)], -1)
        for w, b, n in (("hidden_weights", "hidden_bias", 4), ("direct_weights", "output_bias", 2))
    ]
    whole = np.concatenate([x.reshape(*cases, -1) for x in (*into, exact["output_weights"])], -1)
    np.testing.assert_allclose(jacobian(weights, data.x), whole, atol=1e-14)
    kernel = whole.reshape(-1, whole.shape[-1])
    lazy = Lazy(weights, data).curvatures
    exact = np.linalg.eigvalsh(kernel @ kernel.T)[::-1][: lazy.size]
    np.testing.assert_allclose(lazy, exact, atol=1e-11 * lazy[0])
    assert lazy.size == kernel.shape[1] < len(kernel) and (np.diff(lazy) <= 0).all()


def test_prediction_is_descent_of_the_linearised_network(data):
    weights, momentum, warm_up, rate = start(), 0.9, 20, 2.0
    j = jacobian(weights, data.x)
    j, eps = j.reshape(-1, j.shape[-1]), rate / len(data.x)
    begun = (weights.activity(data.x)[1] - data.y).ravel()
    change, step, errors = np.zeros(j.shape[1]), np.zeros(j.shape[1]), []
    for epoch in range(201):
        errors.append(begun + j @ change)
        alpha = 0.5 if epoch < warm_up else momentum
        last, step = change, alpha * step - eps * j.T @ errors[-1]
        change = change + step
    course = Lazy(weights, data).predict(rate, [0, 5, 200], momentum, warm_up)
    for k, epoch in enumerate((0, 5, 200)):
        np.testing.assert_allclose(course.error[k].ravel(), errors[epoch], atol=1e-10)
    after, size = course.weights[2], weights.rows.size
    np.testing.assert_allclose((after.rows - weights.rows).ravel(), last[:size], atol=1e-10)
    second = (after.output_weights - weights.output_weights).ravel()
    np.testing.assert_allclose(second, last[size:], atol=1e-10)
    assert abs(last[size:]).max() > 1e-3
