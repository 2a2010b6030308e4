"""The table of regions and the heat map of the gap are two looks at the same numbers."""

import re

import numpy as np
import pytest

import winch_friction as wf
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.preparation.prepare import READ_AS
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.channels import RPM
from winch_friction.report.gap_plots import heat_plot


@pytest.fixture(scope="module")
def result():
    crane, truth = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    runs = [
        wf.simulate("normal_joystick", crane, truth, seed=k, hidden={"brake_drag": 2.0}, duration=60.0,
                    load={"value": mass, "unit": "t"}).run
        for k, mass in enumerate((20, 60, 90, 40, 75))
    ]  # fmt: skip
    return find_gap(runs, crane, truth, GapOptions(plan=False, proposals=False))


def mask_of(where, blocks):
    """The blocks of a region, from its words as the table shows them."""
    mask = np.ones(len(blocks.y), bool)
    for part in re.split(r" and |, ", where):
        if part in ("hoisting", "lowering"):
            mask &= blocks.direction == (1 if part == "hoisting" else -1)
            continue
        name, sign, level = re.match(r"(\S+) ([<>]) (\S+)", part).groups()
        values = blocks.features[name] * READ_AS.get(name.rpartition(".")[2], (1.0, ""))[0]
        mask &= np.isfinite(values) & ((values < float(level)) if sign == "<" else (values > float(level)))
    return mask


def test_a_regions_mean_is_that_of_its_blocks(result):
    blocks, gap = result.train.blocks, result.train.before
    assert result.regions
    for region in result.regions:
        mask = mask_of(region.where, blocks)
        assert float(gap[mask].mean()) == pytest.approx(region.mean_residual, rel=0.05), region.where
        assert float((gap[mask] ** 2).sum() / (gap**2).sum()) == pytest.approx(region.share_of_gap, abs=0.02)


def test_the_heat_map_has_the_same_sign_and_mean(result):
    blocks, gap = result.train.blocks, result.train.before
    heats = {heat.title: heat for heat in heat_plot(result).heats}
    assert set(heats) == {"hoisting", "lowering"}
    for sign, title in ((1, "hoisting"), (-1, "lowering")):
        own, heat = blocks.direction == sign, heats[title]
        x = blocks.features["motor_speed"][own] / RPM
        y = blocks.features["hook_load"][own] / 1e3
        assert np.asarray(heat.values).shape == (len(heat.y), len(heat.x))
        width, height = heat.x[1] - heat.x[0], heat.y[1] - heat.y[0]
        compared = 0
        for j, i in np.argwhere(np.isfinite(heat.values)):
            inside = (np.abs(x - heat.x[i]) < width / 2) & (np.abs(y - heat.y[j]) < height / 2)
            if inside.sum() > 2:
                assert heat.values[j, i] == pytest.approx(float(gap[own][inside].mean()), rel=0.2, abs=1e-3)
                compared += 1
        assert compared >= 3
