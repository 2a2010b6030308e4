"""Stepping and running at once are one computation; seeds decide what is random."""

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.simulation import Simulator, simulate


def same(a, b):
    return list(a.columns) == list(b.columns) and all(np.array_equal(a[c], b[c], equal_nan=True) for c in a.columns)


@pytest.mark.parametrize("changes", [{}, {"sensors.dropout_rate": 0.5}, {"sensors.delay": 0.05, "drive": "secondary"}])
def test_stepping_equals_running_at_once(changes, ahc, crane, model):
    scenario = ahc.override({**changes, "duration": 12.0})
    feedforward = 300.0 * np.sin(np.arange(1200) / 80.0)
    stepped = Simulator(scenario, crane, model, seed=2)
    samples = [stepped.sample]
    for value in feedforward:
        sample = stepped.step(value)
        if stepped.fresh:
            samples.append(sample)
    whole = simulate(scenario, crane, model, seed=2, feedforward=feedforward)
    assert stepped.finished
    assert same(stepped.result().truth, whole.truth)
    assert same(stepped.result().run, whole.run)
    replayed = list(whole.run.samples())
    assert [s.time for s in samples] == [s.time for s in replayed]
    assert repr(samples) == repr(replayed)


def test_a_run_may_be_finished_at_once_after_steps(ahc, crane, model):
    scenario = ahc.override({"duration": 5.0})
    simulator = Simulator(scenario, crane, model, seed=1)
    for _ in range(100):
        simulator.step(0.0)
    assert same(simulator.run().truth, simulate(scenario, crane, model, seed=1).truth)


def test_seeds_change_sea_and_noise_and_nothing_else_does(ahc, crane, model):
    sea = ahc.override({"sea": {"kind": "jonswap", "significant_height": 2.0}, "duration": 20.0})
    first, again, other = (simulate(sea, crane, model, seed) for seed in (1, 1, 2))
    assert same(first.run, again.run)
    assert not np.array_equal(first.truth["heave"], other.truth["heave"])
    fixed = sea.override({"sea.seed": 9})
    a, b = (simulate(fixed, crane, model, seed) for seed in (1, 2))
    assert np.array_equal(a.truth["heave"], b.truth["heave"])
    assert not np.array_equal(a.run["active.pressure_a"], b.run["active.pressure_a"])


def test_a_scenario_that_is_over_says_so(ahc, crane, model):
    simulator = Simulator(ahc.override({"duration": 0.05}), crane, model)
    while not simulator.finished:
        simulator.step(0.0)
    with pytest.raises(InputError, match="is over after 0.05 s"):
        simulator.step(0.0)


def test_truth_names_what_matters(ahc, crane, model):
    simulator = Simulator(ahc, crane, model)
    simulator.step(0.0)
    assert {"friction_torque", "position_error", "energy_friction", "motor_speed"} <= set(simulator.truth())


def test_feedforward_of_the_true_friction_improves_both_drives(ahc, crane, model):
    """The physics of docs/simulation.md: the friction known, the load stays put far better."""
    for drive, least in (("primary", 0.6), ("secondary", 0.7)):
        scenario = ahc.override({"drive": drive, "duration": 60.0})
        without = simulate(scenario, crane, model)
        friction = np.append(without.truth["friction_torque"][4:], np.zeros(3))  # 30 ms ahead
        with_it = simulate(scenario, crane, model, feedforward=friction)
        rms = [np.sqrt(np.mean(r.truth["position_error"][2000:] ** 2)) for r in (without, with_it)]
        assert rms[1] < (1.0 - least) * rms[0]


def test_a_seed_below_zero_is_refused(ahc, crane, model):
    with pytest.raises(InputError, match="seed -1: give a whole number, 0 or more"):
        Simulator(ahc, crane, model, seed=-1)
