"""A curve of the model, fitted once more, goes on as it went where none of its runs has been; and has no place to bend
between what no sensor tells apart."""

from dataclasses import replace

import numpy as np
import pytest

from campaign.rig import make_dataset
from winch_friction.discrepancy import repair
from winch_friction.discrepancy.candidates import families
from winch_friction.discrepancy.expansion import meet
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.table import Table, tabulated
from winch_friction.physics.signals import Run


@pytest.fixture(scope="module")
def runs():
    return [Run(f"run_{k}", columns) for k, columns in enumerate(make_dataset(4011, "quiet", (), length=0.2)[:6])]


def test_a_curve_goes_on_as_it_went_where_no_run_comes(runs, crane_150t, crane2_model):
    """A few samples reach a little into its last interval: over these any slope fits."""
    given = meet(runs, crane_150t, crane2_model)
    top = max(float(run.drum_torque.max()) for run in given.prepared)
    knots = (0.0, 0.3 * top, 0.6 * top, 0.99 * top, 1.5 * top)
    term = tabulated(Table("grip", (("drum_torque", knots),), shape="rising", anchor="low", typical=100.0))
    values = (*crane2_model.values, 60.0, 60.0, 80.0, 100.0)
    deviations = (*crane2_model.std, 5.0, 5.0, 5.0, 1e6)
    model = FrictionModel(
        "gripped", (*crane2_model.terms, term), values, np.diag(np.square(deviations)), crane2_model.bounds,
        crane2_model.constants,
    )  # fmt: skip
    loose = dict(zip(model.parameter_names, deviations, strict=True))
    now = replace(meet(runs, crane_150t, model), model=model)
    step, _, _ = repair._step(now, model, loose)
    slopes = (np.array(values) + step)[-4:] / np.diff(knots)
    assert 0.3 < slopes[-1] / slopes[-2] < 3.0


@pytest.mark.parametrize(("values", "knots"), [
    ((0.0, 1.0, 2.0, 3.0, 4.0), 5),
    ((0.0, 1.0, 1.01, 3.99, 4.0), 3),  # loads that are the same but for their cell
    ((2.0, 2.0, 2.0, 2.0, 2.0), 1),
    ((), 0),
])  # fmt: skip
def test_a_curve_bends_only_between_what_a_sensor_tells_apart(values, knots):
    at = families._knots(np.array(values), (0.0, 0.25, 0.5, 0.75, 1.0))
    assert len(at) == knots
    assert not values or (at[0], at[-1]) == (min(values), max(values))


def test_runs_that_differ_by_their_stroke_sensor_alone_have_no_curve_over_the_stroke(runs, crane_150t, crane2_model):
    """A fixed motor: a curve between the means of its noise would be a list of the runs."""
    prepared = meet(runs, crane_150t, crane2_model).prepared
    full = dict(prepared[0].constants)["max_displacement"]
    noise = 1e-5 * full * np.arange(len(prepared))

    def fixed(run, off):
        groups = tuple(replace(g, displacement=np.full_like(g.displacement, full - off)) for g in run.groups)
        return replace(run, groups=groups)

    same = [fixed(run, off) for run, off in zip(prepared, noise, strict=True)]
    of_stroke = {"free_low_displacement_loss_pressure_falling", "free_low_displacement_loss_falling"}
    drawn = {each.law_name for each in families.free_members(prepared, crane2_model)}
    assert of_stroke & drawn
    assert not of_stroke & {each.law_name for each in families.free_members(same, crane2_model)}
