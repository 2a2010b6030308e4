"""A wire that is counted on the drum: the speed was turned by it, and swapped ports were said to be the cause."""

from dataclasses import replace

import numpy as np
import pytest
from importing.logs import GERMAN, example, rows_of, write_text

from winch_friction.cli.main import run
from winch_friction.importing.balance import opposes_motion
from winch_friction.importing.kinematics import Ratio, rope_over_motor


@pytest.fixture
def proposed(tmp_path, capsys):
    """What `import --propose` says of rows: the status and its words."""

    def ask(rows):
        log = write_text(tmp_path / "log.csv", rows)
        status = run(
            [
                "import",
                str(log),
                "--propose",
                "--crane",
                "crane_150t",
                "--map",
                str(tmp_path / "map.yaml"),
                "--overwrite",
            ]
        )
        return status, capsys.readouterr()

    return ask


def test_a_wire_on_the_drum_is_asked_about_and_turns_no_speed(proposed):
    base = example("test_02")
    rows = rows_of(base, GERMAN | {"wire_out": ("Seillänge Trommel [m]", -1.0, 3)})
    at = rows[0].index("Seillänge Trommel [m]")
    for row in rows[1:]:
        row[at] = f"{400.0 + float(row[at].replace(',', '.')):.3f}".replace(".", ",")
    status, said = proposed(rows)
    assert status == 2
    assert "wire_out: 'Seillänge Trommel [m]' grows where friction and load say that the winch hoists" in said.err
    assert "is it the wire that lies on the drum? Take wire_out out of the map" in said.err
    assert "set motor_speed.sign=-1" in said.err
    assert "-1 * " not in said.out  # the speed is as it stands in the log


@pytest.mark.parametrize("name", ["test_02", "test_12"])  # the second: the bare hook, whose load tells little
def test_ports_that_are_swapped_are_still_told_as_such(proposed, name):
    swapped = {"main.pressure_a": GERMAN["main.pressure_b"], "main.pressure_b": GERMAN["main.pressure_a"]}
    status, said = proposed(rows_of(example(name), GERMAN | swapped))
    assert status == 2
    assert "lies on the drum" not in said.err
    assert "the ports are swapped" in said.err


def test_a_speed_that_counts_lowering_is_turned_by_the_wire(proposed):
    words = GERMAN | {"motor_speed": ("Windendrehzahl [1/min]", -GERMAN["motor_speed"][1], 1)}
    status, said = proposed(rows_of(example("test_02"), words))
    assert status == 0, said.err
    assert "motor_speed <- Windendrehzahl [1/min] (-1 * 1/min)" in said.out


@pytest.mark.parametrize("sign", [-1, 1])
def test_what_tells_the_speed_again_is_turned_with_it(proposed, sign):
    """Of a log that counts paying out the speed alone was turned: a replay fed forward against the motion."""
    base = example("test_02")
    angle = np.concatenate([[0.0], np.cumsum(base["motor_speed"][1:] * np.diff(base.time))])
    more = {"speed_reference": np.roll(base["motor_speed"], -4), "shaft_angle": angle}
    one = sign * GERMAN["motor_speed"][1]
    words = {"motor_speed": ("Windendrehzahl [1/min]", one, 1), "speed_reference": ("Solldrehzahl [1/min]", one, 1),
             "shaft_angle": ("Motorwinkel [rad]", sign, 3)}  # fmt: skip
    status, said = proposed(rows_of(replace(base, columns={**base.columns, **more}), GERMAN | words))
    assert status == 0, said.err
    turned = "-1 * " if sign < 0 else ""
    assert f"speed_reference <- Solldrehzahl [1/min] ({turned}1/min)" in said.out
    assert f"shaft_angle <- Motorwinkel [rad] ({turned}rad)" in said.out
    assert said.out.count("it runs against the motor's speed") == (2 if sign < 0 else 0)


def test_a_row_without_a_time_hides_no_friction(crane_150t):
    """It ended in a traceback: a log with a second table below it has such rows."""
    columns = {name: values.copy() for name, values in example("test_02").columns.items()}
    told = opposes_motion(columns, crane_150t)
    columns["time"][100] = np.nan
    assert opposes_motion(columns, crane_150t) == pytest.approx(told, rel=0.1)


def test_a_heave_that_the_winch_follows_tells_sign_and_size_of_its_speed(crane_150t):
    """Up goes the tip, out goes the wire."""
    time = 0.1 * np.arange(600)
    heave = 0.8 * np.sin(time)
    speed = -heave * crane_150t.gear_ratio / crane_150t.drum.layer_radii[-1]
    for sign in (1.0, -1.0):
        found = rope_over_motor({"time": time, "motor_speed": sign * speed, "heave_velocity": heave}, crane_150t)
        assert found == Ratio(pytest.approx(sign), "heave_velocity")
