"""Whether a wire gives is decided by all runs, also where the model is fitted to some of them."""

from campaign.gap_hard_cases import all_cases, runs_of
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.expansion import meet
from winch_friction.discrepancy.workflow import find_gap


def test_a_model_is_fitted_to_a_load_that_swings_as_all_runs_say_it_does(crane_150t, crane2_model):
    """Three of six runs tell a swing, of the four to learn from one: fitted to a rigid wire the model would be wrong by
    six times the noise."""
    (case,) = [each for each in all_cases(quick=False) if each.seed == 300_165]
    runs = runs_of(case)
    every = meet(runs, crane_150t, crane2_model)
    some = every.only([run.name for run in runs[:2]])
    assert [run.name for run in some.prepared] == [run.name for run in some.runs] == [run.name for run in runs[:2]]
    assert some.prepared == every.prepared[:2]
    result = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    assert result.verdict == "nothing_missing"
    held = result.holdout
    assert held.size_after.value < 1.5 * held.noise_floor
