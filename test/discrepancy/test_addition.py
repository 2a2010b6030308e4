"""What a user's own simulation lacks, as a table: the repaired torque less the given one, over what was run."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.addition import FEWEST, addition_table
from winch_friction.physics.channels import CM3_PER_REV, RPM

GIVEN = SimpleNamespace(torque=lambda point: 3.0 * point[0])
REPAIRED = SimpleNamespace(torque=lambda point: 3.0 * point[0] + 20.0 * np.sign(point[0]))


def run(speed, load, displacement):
    size = len(speed)
    group = SimpleNamespace(balances=True, displacement=np.full(size, displacement * CM3_PER_REV))
    return SimpleNamespace(
        time=np.arange(size), speed=speed, load=np.full(size, load), groups=[group], point=(speed,),
        used=np.ones(size, bool),
    )  # fmt: skip


def test_the_table_is_what_has_to_be_added_over_there_in_the_units_of_its_header():
    speed = np.repeat([-1000.0, 1000.0], 30) * RPM
    rows = addition_table([run(speed, 2e4, 215.0), run(speed, 8e4, 110.0)], GIVEN, REPAIRED)
    assert len(rows) == 4
    for rpm, tonnes, swept, samples, torque in rows:
        assert abs(rpm) == pytest.approx(1000.0)
        assert (tonnes, swept) in (pytest.approx((20.0, 215.0)), pytest.approx((80.0, 110.0)))
        assert samples == 30.0
        assert torque == pytest.approx(20.0 * np.sign(rpm))


def test_a_cell_of_a_few_samples_says_nothing():
    speed = np.concatenate([np.full(50, 1000.0), np.full(FEWEST - 1, -300.0)]) * RPM
    assert [round(row[0]) for row in addition_table([run(speed, 2e4, 215.0)], GIVEN, REPAIRED)] == [1000]
