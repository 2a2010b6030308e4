"""A loss that a small load calls up already and a large one hardly raises: a load's, and no pressure's."""

from dataclasses import replace

import numpy as np
import pytest
from gap_rig import names_of, runs_with

from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.channels import GRAVITY

CLOSED = 1.6e5  # N m of drum torque, at which the contact is closed by three quarters; tanh, which the package lacks
LARGEST = 60.0  # N m at the shaft


def dragging(run, crane):
    """The run with the pressures that a contact costs which the load closes."""
    groups = [name for name in ("main", "active") if f"{name}.pressure_a" in run.columns]
    swept = sum(crane.groups[name] * run[f"{name}.displacement"] for name in groups)
    layer = np.rint(run["wire_layer"]).astype(int)
    torque = run["hook_load"] * GRAVITY * np.array(crane.drum.layer_radii)[layer - 1]
    drag = LARGEST * np.tanh(torque / CLOSED) * np.tanh(run["motor_speed"] / 0.5)
    more = {f"{name}.pressure_a": run[f"{name}.pressure_a"] + drag / swept for name in groups}
    return replace(run, columns={**run.columns, **more})


@pytest.mark.long
def test_a_loss_that_saturates_with_the_load_is_the_loads(crane_150t, crane2_model):
    runs = [dragging(run, crane_150t) for run in runs_with(4412, "quiet", length=0.3)]
    result = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    assert len(result.effects) == 1
    assert names_of(result)[0] >= {"gear_load_loss", "sheave_bending"}
    assert result.effects[0].law_name in ("gear_load_saturating", "sheave_saturating")
    assert result.holdout.size_after.value < 0.3 * result.holdout.size_before.value
