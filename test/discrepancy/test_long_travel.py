"""Contacts that turn over within a radian and more of the shaft show among the moving samples and are presliding."""

from dataclasses import replace

import numpy as np
import pytest
from gap_rig import names_of, runs_with

from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.workflow import find_gap

CARRIED = 15.0  # N m per motor shaft
CONTACTS = ((0.8, 0.6), (2.5, 0.4))  # rad of an e-fold, share: the law of the package has one


def turning_over(run, crane):
    """The run with the pressures of friction that comes back over some travel after each reversal."""
    groups = [name for name in ("main", "active") if f"{name}.pressure_a" in run.columns]
    swept = sum(crane.groups[name] * run[f"{name}.displacement"] for name in groups)
    missing = sum(share * (_bristle(run, travel) - np.sign(run["motor_speed"])) for travel, share in CONTACTS)
    torque = CARRIED * sum(crane.groups.values()) * missing
    more = {f"{name}.pressure_a": run[f"{name}.pressure_a"] + torque / swept for name in groups}
    return replace(run, columns={**run.columns, **more})


def _bristle(run, travel):
    """Deflection after Dahl, -1 to 1."""
    found, z = np.empty(len(run.time)), 0.0
    for k, step in enumerate(run["motor_speed"] * np.gradient(run.time)):
        z = np.sign(step) + (z - np.sign(step)) * np.exp(-abs(step) / travel)
        found[k] = z
    return found


@pytest.mark.long
def test_contacts_that_turn_over_within_a_radian_are_presliding(crane_150t, crane2_model):
    runs = [turning_over(run, crane_150t) for run in runs_with(4409, "quiet", length=0.3)]
    result = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    assert names_of(result) == [{"presliding"}]
    assert result.effects[0].law_name == "over a long travel"
    assert 0.5 < result.model.as_dict()["d_z"] < 3.0
    assert result.holdout.size_after.value < 0.5 * result.holdout.size_before.value
