"""The estimator on cranes of 5 t to 900 t: what its defaults mean goes with the crane."""

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_winch import drawn_crane, learned

from winch_friction.estimation import EstimatorConfig, FrictionEstimator, chi_squared
from winch_friction.estimation.config import at_its_size, damping_ratio, torque_ratio
from winch_friction.records.crane_file import load_crane

DRAWS, DIRECTIONS = 5, 3
SIZES = {"5 t": (5.0, "hydraulic"), "16 t electric": (16.0, "electric"), "150 t": None, "900 t": (900.0, "hydraulic")}


@pytest.mark.slow
# the shipped crane's size is that of most other tests here
@pytest.mark.parametrize("size", [
    each if each == "16 t electric" else pytest.param(each, marks=pytest.mark.long) for each in SIZES
])  # fmt: skip
def test_what_is_learned_is_as_sure_as_it_says_on_a_crane_of_any_size(crane, size):
    """10 N m and 1 N m/sqrt(s) are much on a winch of 5 t and next to nothing on one of 900 t."""
    squares = 0.0
    for draw in range(DRAWS):
        rng = np.random.default_rng(78_000 + draw)
        winch = drawn_crane(*SIZES[size], rng) if SIZES[size] else crane
        estimator, nees = learned(winch, rng)
        squares += nees
        assert estimator.counts["rejected"] < 0.01 * estimator.counts["accepted"]
        assert estimator.consistency.share_inside >= 0.85
    lower, upper = (chi_squared.quantile(p, DIRECTIONS * DRAWS) for p in (0.005, 0.995))
    assert lower < squares < upper


def test_the_reference_crane_keeps_the_defaults(crane):
    assert at_its_size(EstimatorConfig(), crane) == EstimatorConfig()


@pytest.mark.parametrize("tonnes", [5.0, 16.0, 900.0])
def test_torques_go_with_the_rated_torque_and_the_damping_ratio_stays(crane, tonnes):
    winch = drawn_crane(tonnes, "hydraulic", np.random.default_rng(3))
    config, usual = at_its_size(EstimatorConfig(), winch), EstimatorConfig()
    for name in ("disturbance_std", "load_noise"):
        shares = [
            getattr(c, name) * each.gear_ratio / each.drum_torque(each.rated_load)
            for c, each in ((config, winch), (usual, crane))
        ]
        assert shares[0] == pytest.approx(shares[1], rel=1e-12)
    ratios = [
        c.wire_damping / math.sqrt(each.wire_stiffness * each.rated_load)
        for c, each in ((config, winch), (usual, crane))
    ]
    assert ratios[0] == pytest.approx(ratios[1], rel=1e-12)


def test_what_somebody_sets_is_taken_as_it_is():
    winch = drawn_crane(5.0, "hydraulic", np.random.default_rng(3))
    said = EstimatorConfig(disturbance_std=4.0, load_noise=0.0, wire_damping=1e3)
    assert at_its_size(said, winch) == said


def test_without_a_rated_load_the_motors_say_the_size_and_else_the_bound(crane):
    bare = replace(crane, rated_load=0.0)
    assert torque_ratio(bare) == damping_ratio(bare) == 1.0
    half = replace(bare, max_displacement=0.5 * crane.max_displacement)
    assert torque_ratio(half) == 0.5
    assert torque_ratio(replace(bare, rated_pressure=0.5 * crane.rated_pressure)) == 0.5
    assert torque_ratio(load_crane("emps")) == 100.0 / 2000.0
    silent = replace(load_crane("emps"), absolute_torque_limit=math.inf)
    assert torque_ratio(silent) == 1.0


def test_a_wire_of_which_nothing_is_said_is_damped_by_the_load(crane):
    assert damping_ratio(replace(crane, wire_stiffness=math.inf)) == 1.0
    double = replace(crane, rated_load=2.0 * crane.rated_load)
    assert damping_ratio(replace(double, wire_stiffness=math.inf)) == 2.0
    assert damping_ratio(double) == math.sqrt(2.0)


def test_the_status_tells_the_numbers_in_use(crane, seed):
    winch = replace(crane, rated_load=0.5 * crane.rated_load)
    status = FrictionEstimator(winch, seed).status()
    assert status["disturbance_std"] == 5.0
    assert status["load_noise"] == 0.5
    assert status["wire_damping"] == pytest.approx(1.5e5 * math.sqrt(0.5))
