"""What repeats with the drum's turn is named with its order, and asks for an angle that counts the turns."""

from dataclasses import replace

import numpy as np
import pytest
from gap_rig import names_of, runs_with

from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.candidates.candidate import ANGLE
from winch_friction.discrepancy.catalogue import (
    CAUSE,
    FASTEST,
    HARMONICS,
    ONE,
    all_candidates,
    candidates_for,
    drum_ripples,
)
from winch_friction.discrepancy.detectors.ripple import LOWEST_ORDER
from winch_friction.discrepancy.preparation.prepare import prepare
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction import term_named
from winch_friction.physics.signals import Run

SHARE = 0.012  # of T_d/i


def with_waves(run, crane, **orders):
    """A run whose pressures carry a sine of so many periods per turn of the drum, by its share of T_d/i."""
    columns = {name: np.array(values) for name, values in run.columns.items()}
    group = "main" if "main.pressure_a" in columns else "active"
    radius = np.array([crane.drum.radius(layer) for layer in columns["wire_layer"]])
    turned = columns["shaft_angle"] / crane.gear_ratio
    waves = sum(share * np.sin(float(order.removeprefix("k")) * turned) for order, share in orders.items())
    torque = waves * np.median(columns["hook_load"]) * GRAVITY * radius / crane.gear_ratio
    displacement = crane.groups[group] * columns[f"{group}.displacement"]
    return Run(run.name, columns | {f"{group}.pressure_a": columns[f"{group}.pressure_a"] + torque / displacement})


@pytest.mark.parametrize(("orders", "law", "size"), [
    pytest.param({"k3": SHARE}, ONE, ("a_d", "k_d", 3.0), marks=pytest.mark.long),
    pytest.param(
        {"k1": SHARE, "k2": 0.5 * SHARE, "k3": 0.3 * SHARE}, HARMONICS, ("a_d1", "k_dh", 1.0), marks=pytest.mark.long
    ),
])  # fmt: skip
def test_what_repeats_with_the_drums_turn_is_a_ripple_of_that_order(orders, law, size, crane_150t, crane2_model):
    runs = [with_waves(run, crane_150t, **orders) for run in runs_with(23, "quiet", length=1.0)]
    result = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    assert names_of(result) == [{CAUSE}]
    found = result.effects[0]
    amplitude, order, times = size
    assert found.law_name == law
    assert found.parameters[amplitude].value == pytest.approx(SHARE, rel=0.1)
    assert found.parameters[order].value == times


def test_an_angle_that_does_not_count_the_turns_cannot_show_it(crane_150t, crane2_model):
    runs = runs_with(23, "quiet", length=0.6)[:3]  # in which the drum turns more than once
    prepared = [prepare(run, crane_150t, crane2_model) for run in runs]
    assert [each.untestable(prepared) for each in drum_ripples(prepared, crane2_model)] == [None, None]
    wrap = 1.2 * crane_150t.gear_ratio * 2.0 * np.pi  # a turn of the drum and more, but not as far as the speed tells
    for change in (lambda a: np.mod(a, 2.0 * np.pi), lambda a: 0.01 * a, lambda a: np.mod(a, wrap)):
        other = [replace(run, angle=change(run.angle)) for run in prepared]
        assert all(each.untestable(other).needs == "shaft_angle" for each in drum_ripples(other, crane2_model))


def test_a_ripple_that_the_model_has_is_none_to_be_found(crane_150t, crane2_model):
    prepared = [prepare(runs_with(23, "quiet")[0], crane_150t, crane2_model)]
    term = term_named(ONE)
    own = tuple(p.typical for p in term.parameters)
    known = replace(
        crane2_model, terms=(*crane2_model.terms, term), values=(*crane2_model.values, *own), covariance=None
    )
    assert [each.law_name for each in drum_ripples(prepared, known)] == [HARMONICS]
    assert {ONE, HARMONICS} <= {each.law_name for each in candidates_for(prepared, crane2_model)}
    assert [each.name for each in all_candidates() if each.regime == ANGLE] == [CAUSE]
    assert FASTEST == LOWEST_ORDER == 0.1  # the spectrum takes over
