"""What hangs, and on which radius: the columns of a tare and of a radius, and the corrections that they become."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gap_rig import names_of, runs_with

from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate, Shape, Sides
from winch_friction.discrepancy.candidates.geometry import (
    ONE_DEPTH,
    THICKER,
    geometry_candidates,
    layers_apart,
    radius_columns,
    tare_columns,
)
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.channels import GRAVITY
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

LEVER, GEAR = np.array([0.9, 1.0, 1.1]), 250.0
HEAVE = np.array([0.0, 0.5, -0.5])  # m/s^2
LENGTH, LAYER = np.array([10.0, 40.0, 90.0]), np.array([1.0, 2.0, 2.0])
LOAD, LOSS = 5e4, 300.0


def run():
    return SimpleNamespace(
        time=np.zeros(3), load=np.full(3, LOAD), radius=LEVER, gear_ratio=GEAR, load_acceleration=HEAVE,
        load_friction=np.full(3, LOSS), acceleration=np.array([0.0, 2.0, 0.0]), tension_measured=False,
        channels={"wire_out": LENGTH, "wire_layer": LAYER},
    )  # fmt: skip


def hanging(mass):
    """Weight and inertia on the lever, and the loss of the load in proportion."""
    return mass * LEVER / GEAR * (GRAVITY + HEAVE) + mass / LOAD * LOSS


def test_a_tare_hangs_and_is_accelerated_and_loses_as_the_load_does():
    columns = tare_columns(run(), {"hook": 1.0, "wire": 1.0})
    assert columns[:, 0] == pytest.approx(hanging(1.0))
    assert columns[:, 1] == pytest.approx(hanging(LENGTH))
    assert not tare_columns(run(), {"hook": 0.0, "wire": 1.0})[:, 0].any()


def test_a_radius_is_wrong_on_the_layers_that_its_shape_speaks_of():
    inertia = LOAD * (LEVER / GEAR) ** 2 * np.array([0.0, 2.0, 0.0])
    whole = hanging(LOAD) + inertia
    assert radius_columns(run(), {"layer": 0.0})[:, 0] == pytest.approx(whole)
    assert radius_columns(run(), {"layer": 2.0})[:, 0] == pytest.approx(whole * [0.0, 1.0, 1.0])
    assert radius_columns(run(), {"layer": -3.0})[:, 0] == pytest.approx(whole * [2.0, 1.0, 1.0])
    assert radius_columns(run(), {"layer": ONE_DEPTH})[:, 0] == pytest.approx(whole / LEVER)
    thicker = [0.0, 0.1, 0.1] / LEVER  # of a rope that is a tenth of a metre thicker than the crane file's
    assert radius_columns(run(), {"layer": THICKER})[:, 0] == pytest.approx(whole * thicker)


@pytest.mark.parametrize(
    ("layer", "values"),
    [
        (0.0, {1: 0.016, 2: 0.018}),
        (2.0, {2: 0.018}),
        (-2.0, {1: 0.016}),
        (-3.0, {1: 0.032, 2: 0.018}),
        (THICKER, {2: 0.002}),
    ],
)
def test_a_radius_error_becomes_metres_on_the_layers_concerned(layer, values):
    sides = Sides(SimpleNamespace(drum=SimpleNamespace(layer_radii=(0.8, 0.9))), ("main",), ())
    own = geometry_candidates()[1]
    found = own.corrects({"e_R": ParameterEstimate(0.02, 0.001, "1")}, Shape("", {"layer": layer}), sides)
    assert {each.layers[0]: each.value for each in found} == pytest.approx(values)


def test_a_layer_that_is_a_hair_below_its_number_is_that_layer():
    """On the grid of a run a layer lies between two samples at times, and rounding leaves less than a whole."""
    own = run()
    own.channels["wire_layer"] = np.array([1.0, 1.9999999, 1.9999999])
    assert [p.name for p in layers_apart([own])[0].linear] == ["e_R1", "e_R2"]


def test_every_layer_may_have_an_error_of_its_own_where_there_is_more_than_one():
    """Of two that were off by 0.9 and 1.7 % a gain of the pressures took what both had, and a radius the other half."""
    own = run()
    own.channels["wire_layer"] = np.array([2.0, 2.0, 2.0])
    assert layers_apart([own]) == []  # that of all says as much
    own.channels["wire_layer"] = np.array([1.0, 2.0, 2.0])
    assert [p.name for p in layers_apart([own])[0].linear] == ["e_R1", "e_R2"]
    own.channels["wire_layer"] = np.array([1.0, 2.0, 4.0])  # of a drum of four; the third no run has
    (law,) = layers_apart([own])
    assert law.varies_with == ("drum_torque", "wire_layer")  # of no other signal
    assert (law.name, [p.name for p in law.linear]) == ("layer_radius", ["e_R1", "e_R2", "e_R4"])
    whole = radius_columns(own, {"layer": 0.0})[:, 0]
    np.testing.assert_allclose(law.columns(own, {}), np.diag(whole))
    sides = Sides(SimpleNamespace(drum=SimpleNamespace(layer_radii=(0.8, 0.9, 1.0, 1.1))), ("main",), ())
    found = {p.name: ParameterEstimate(0.01 * k, 0.001, "1") for k, p in enumerate(law.linear, start=1)}
    written = law.corrects(found, Shape(""), sides)
    assert {each.layers: each.value for each in written} == pytest.approx({(1,): 0.008, (2,): 0.018, (4,): 0.033})
    del found["e_R2"]  # on which no run that taught has been
    assert {each.layers for each in law.corrects(found, Shape(""), sides)} == {(1,), (4,)}


@pytest.mark.long
def test_a_load_that_gathers_over_the_days_is_a_tare():
    """Mud on the block by the dates of the runs: `unexplained`, with the oil's temperature first."""
    runs = runs_with(33, "quiet")
    starts = [float(each.time[0]) for each in runs]
    share = [(start - min(starts)) / (max(starts) - min(starts)) for start in starts]
    muddy = [
        replace(run, columns={**run.columns, "hook_load": run.columns["hook_load"] - 2500.0 * own})
        for run, own in zip(runs, share, strict=True)
    ]
    options = GapOptions(plan=False, proposals=False)
    found = find_gap(muddy, load_crane("crane_150t"), load_model("a6vm215_crane2"), options)
    assert names_of(found) == [{"tare_load"}]
    assert found.effects[0].law_name == "gathers over the days"
    assert found.effects[0].parameters["m_d"].value == pytest.approx(2500.0, rel=0.05)
