"""What a user's own simulation lacks, as a table: the repaired torque less the given one, over what was run."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.addition import FEWEST, _levels, addition_table, write_addition
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


def test_as_a_file_the_table_has_its_units_in_the_header_and_six_digits(tmp_path):
    speed = np.full(12, -1234.567) * RPM
    path = write_addition(tmp_path / "add.csv", [run(speed, 54321.9, 215.0)], GIVEN, REPAIRED)
    head, row, end = path.read_text().split("\n")
    assert head == "motor_speed [rpm],hook_load [t],displacement [cm^3/rev],samples [1],torque_to_add [N*m]"
    assert (row, end) == ("-1234.57,54.3219,215,12,-20", "")


def test_speeds_are_one_cell_within_a_fortieth_of_both_ways_and_cells_go_by_what_is_swept_then_by_load():
    """Between -1000 and 1000 rpm: 50 rpm each; what lies at the upper end is in the last of them."""
    speed = np.repeat([-1000.0, -1.0, 1.0, 60.0, 140.0, 160.0, 990.0, 1000.0], 10) * RPM
    rows = addition_table([run(speed, 2e4, 215.0)], GIVEN, REPAIRED)
    assert [round(row[0]) for row in rows] == [-1000, -1, 1, 60, 140, 160, 995]
    falling = addition_table([run(-np.abs(speed), 2e4, 215.0)], GIVEN, REPAIRED)
    assert [round(row[0]) for row in falling] == [-997, -160, -140, -60, -1]
    one = np.full(10, 100.0) * RPM
    several = [run(one, load, swept) for load, swept in ((8e4, 110.0), (2e4, 215.0), (8e4, 215.0), (2e4, 110.0))]
    found = [(row[1], round(row[2])) for row in addition_table(several, GIVEN, REPAIRED)]
    assert found == [(20.0, 110), (80.0, 110), (20.0, 215), (80.0, 215)]


def test_only_what_moves_and_what_drives_is_in_the_table():
    own = run(np.full(30, 500.0) * RPM, 2e4, 215.0)
    own.used[:12] = False
    own.speed[:12] = -900.0 * RPM
    passive = SimpleNamespace(balances=False, displacement=np.full(30, 70.0 * CM3_PER_REV))
    own.groups.insert(0, passive)
    ((rpm, _, swept, samples, _),) = addition_table([own], GIVEN, REPAIRED)
    assert (rpm, swept, samples) == (pytest.approx(500.0), pytest.approx(215.0), 18.0)
    own.groups.remove(own.groups[1])
    assert addition_table([own], GIVEN, REPAIRED)[0][2] == 0.0  # nobody drives


@pytest.mark.parametrize(
    ("values", "levels"),
    [
        ([1.0, 1.02, 1.06, 0.0], [1, 1, 2, 0]),  # beyond three per cent of the largest
        ([-100.0, -99.0, -50.0], [0, 0, 1]),
        ([50.0, 10.0, 30.0, 20.0, 40.0, 0.0], [5, 1, 3, 2, 4, 0]),  # six are as they are
        (list(range(7)), [0, 1, 2, 3, 4, 5, 5]),
        (list(range(12)), [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]),  # of more a sixth each
        ([0.0, 0.0], [0, 0]),
    ],
)
def test_values_that_are_alike_are_one_level_and_there_are_six_at_most(values, levels):
    assert _levels(np.array(values, float)).tolist() == levels
