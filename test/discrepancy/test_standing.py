"""Guards that only a whole data set can break, on drawn cranes that once broke them."""

from types import SimpleNamespace

import numpy as np
import pytest

from campaign.gap import owner_files
from campaign.gap_cases import Case
from campaign.gap_hard_cases import all_cases, runs_of
from campaign.rig import DRAWN, make_dataset
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.candidates.friction import blurred_travel
from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.discrepancy.search import too_short
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.signals import Run


def _answer(kind, seed, *effects):
    case = Case(kind, effects, DRAWN, seed)
    crane, model = owner_files(case)
    data = make_dataset(case.seed, case.flavour, case.effects, sigma=case.sigma)
    runs = [Run(f"run_{k + 1:02d}", columns) for k, columns in enumerate(data)]
    return find_gap(runs, crane, model, GapOptions(plan=False, proposals=False)), model


@pytest.mark.parametrize("seed", [
    10_000_088, *(pytest.param(seed, marks=pytest.mark.long) for seed in (10_000_074, 10_000_096)),
])  # fmt: skip
def test_a_slow_log_and_a_swinging_load_are_not_an_effect(seed):
    """Nothing is hidden: an irregular sea at 10 Hz, where inertia's torque bends between samples, a swing of six
    samples at 20 Hz, and one at 50 Hz that heave compensation blurs and the other runs agree on."""
    result, _ = _answer("drawn_null", seed)
    assert result.verdict == "nothing_missing"


@pytest.mark.parametrize("seed", [1800051, pytest.param(2200048, marks=pytest.mark.long)])
def test_the_blur_of_a_reversal_is_not_presliding(seed):
    """Nothing is hidden; 20 Hz, where three samples after a reversal are a travel, and 166 Hz, where the smoothing
    reaches across it."""
    result, _ = _answer("drawn_null", seed)
    assert result.verdict == "nothing_missing"


@pytest.mark.long
def test_what_is_imitated_after_reversals_by_an_implausible_size_is_no_effect():
    """Nothing is hidden; 167 Hz: a break-away six times as large as it ever was would explain a third of it."""
    result, _ = _answer("drawn_null", 15_100_033)
    assert result.verdict == "nothing_missing"


@pytest.mark.long
@pytest.mark.parametrize(("effect", "seed"), [("power_loss", 19_500_024), ("pressure_memory", 19_500_021)])
def test_a_law_without_its_shape_is_no_name_for_what_none_knows(effect, seed):
    """Load times speed is no notch whose maximum lies at 500 rad/s where the motors do 200, and what remembers
    the pressure no viscosity whose Stribeck curve is wider than all that was driven."""
    result, _ = _answer("drawn_outside", seed, (effect, 1.0))
    assert result.verdict == "unexplained"
    assert result.effects == ()


@pytest.mark.parametrize("rate", [20.0, 50.0])
def test_the_blurred_travel_is_that_of_three_samples(rate):
    """A shaft that turns at 10 rad/s^2 has gone 0.5 a t^2 by then, half a sample more or less."""
    time = np.arange(0.0, 10.0, 1.0 / rate)
    run = SimpleNamespace(speed=10.0 * (time - 5.01), dt=1.0 / rate)
    low, high = (0.5 * 10.0 * (n / rate) ** 2 for n in (2.5, 4.0))
    assert low < blurred_travel([run]) < high
    bristles = next(each for each in all_candidates() if each.name == "presliding")
    refused = [shape.values["d_z"] for shape in bristles.shapes([]) if too_short(bristles, shape, [run])]
    assert refused == ([0.009] if rate == 50.0 else [0.009, 0.02, 0.04, 0.09])
    long = next(each for each in all_candidates() if each.law_name == "over a long travel")
    assert [shape.values["d_z"] for shape in long.shapes([run])] == ([0.3, 1.0, 3.0] if rate == 50.0 else [1.0, 3.0])
    assert blurred_travel([SimpleNamespace(speed=np.full(200, 3.0), dt=0.02)]) == 0.0


@pytest.mark.long
def test_the_ropes_own_weight_speaks_for_a_tare():
    """The rope's weight under 13 bar of gap: inertia_error beside it only mended its second order."""
    result, _ = _answer("law", 16_000_270, ("tare_load:rope_paid_out", 1.0))
    assert [effect.name for effect in result.effects] == ["tare_load"]
    assert result.holdout.size_after.value < 0.1 * result.holdout.size_before.value


@pytest.mark.long
def test_what_a_squeezed_oil_does_after_a_reversal_is_no_dwell():
    """Air in the oil, logged at 200 Hz: a tenth of the error after reversals, a quarter of what is above the noise."""
    case = next(each for each in all_cases(False) if each.seed == 300035)
    assert case.effect == "entrained_air"
    found = find_gap(runs_of(case), *owner_files(Case("single", (), "elastic_still", 1)), GapOptions(plan=False))
    assert "dwell_stiction" not in [effect.name for effect in found.effects]
