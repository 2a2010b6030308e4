"""The last fit of a repaired model, along the path by which its file will be read."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gap_rig import runs_with

from winch_friction.discrepancy import repair
from winch_friction.discrepancy.expansion import with_room
from winch_friction.discrepancy.repair import Repair, _as_found, polished
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.correction import Correction
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model


def test_a_delay_is_all_of_what_the_signals_are_out_of_step_by():
    """Half a sample is within what any log is off by; kept there, it is not in the file."""
    crane, seed = load_crane("crane_150t"), load_model("a6vm215_crane2")
    runs = runs_with(4061, "si_files", ("signal_delay", 1.0), length=0.3)
    late = Correction("signal_delay", 0.047, std=1e-4)  # 50 ms are hidden
    drafted = Repair(replace(seed, corrections=(late,)), {"signal_delay": {}})
    found = polished(drafted, seed, runs, [run.name for run in runs[:3] + runs[9:]], crane).model.corrections
    assert found[0].value == pytest.approx(0.050, abs=5e-4)


ALWAYS, A_TIME = (), ((0.0, 60.0),)


@pytest.mark.parametrize(("corrections", "during", "held"), [
    ((), ALWAYS, False), (("pressure_offset",), ALWAYS, False), (("signal_delay",), ALWAYS, True),
    (("pressure_filter",), ALWAYS, True), (("signal_delay",), A_TIME, False), (("pressure_offset",), A_TIME, False),
])  # fmt: skip
def test_beside_what_makes_a_signal_late_the_tolerance_of_times_is_held(monkeypatch, corrections, during, held):
    """What is late for a time alone says nothing of the runs beyond it."""
    asked = []

    class Asked(Exception):
        """What is held is known; the fit is not wanted."""

    def base_of(*arguments, held):
        asked.append(held)
        raise Asked

    monkeypatch.setattr(repair, "base_of", base_of)
    seed = FrictionModel("m", (term_named("coulomb"),), (50.0,), covariance=np.eye(1))
    model = replace(seed, corrections=tuple(Correction(name, 0.03, during=during) for name in corrections))
    with pytest.raises(Asked):
        repair._step(SimpleNamespace(model=model), seed, {})
    assert asked == [("timing",) if held else ()]


@pytest.mark.parametrize(("after", "said"), [(9.95, 0.995), (5.0, 5.0), (0.2, 0.2)])
def test_what_the_last_fit_says_nothing_of_is_as_uncertain_as_when_it_was_found(after, said):
    """The place of a step has no slope: freed tenfold, it was said to be uncertain by all of itself."""
    seed = FrictionModel("m", (term_named("coulomb"),), (50.0,), covariance=np.eye(1))
    terms = (term_named("coulomb"), term_named("high_pressure_onset"))
    values = (50.0, 10.0, 1e7, 60.0)
    drafted = FrictionModel("m", terms, values, covariance=np.diag([1.0, 0.04, 1.0, 9.0]))
    fitted = replace(drafted, covariance=np.diag([0.99, 0.01, after**2, 4.0]))
    assert _as_found(fitted, drafted, seed).std == pytest.approx((np.sqrt(0.99), 0.1, said, 2.0))


@pytest.mark.parametrize(("named", "end", "room"), [(False, 14.0, 14.0), (False, 13.9, 10.0), (True, 14.0, 10.0)])
def test_what_a_fit_took_to_the_end_of_its_room_is_given_room_around_there_but_nothing_of_the_seed_is(named, end, room):
    """A Stribeck speed of 38 rad/s from a grid, where 10 is true, held the Coulomb friction at 20 of its deviations."""
    prior = FrictionModel("m", (term_named("coulomb"),), (10.0,), covariance=np.diag([4.0]))
    seed = prior if named else FrictionModel("bare", (), ())
    found = with_room(prior, prior.with_values([end]), {"C2": 2.0}, seed)
    assert found.values == (room,)
