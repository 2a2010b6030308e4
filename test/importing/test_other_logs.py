"""Logs that are no run of the winch: what ended in a traceback, and what is said of a log that lacks a channel."""

import numpy as np
from importing.logs import GERMAN, example, rows_of, write_text

from winch_friction.cli.main import run

HEAVE = "time [s],heave [m],roll [deg]\n" + "".join(
    f"{k},{np.sin(0.6 * k):.3f},{np.cos(0.6 * k):.2f}\n" for k in range(100)
)


def imported(log, tmp_path, *more):
    return run(["import", str(log), "--map", str(tmp_path / "map.yaml"), "--out", str(tmp_path / "runs"), *more])


def proposed(log, tmp_path, *more):
    return run(["import", str(log), "--map", str(tmp_path / "map.yaml"), "--crane", "crane_150t", "--propose", *more])


def test_a_ships_motion_is_imported_although_the_map_names_a_crane(tmp_path, capsys):
    """The torque balance was asked of a log without a drive: a traceback."""
    log = tmp_path / "seapath.csv"
    log.write_text(HEAVE)
    assert proposed(log, tmp_path) == 0
    assert imported(log, tmp_path) == 0, capsys.readouterr().err
    assert (tmp_path / "runs" / "seapath.csv").read_text().startswith("time [s],heave_velocity [m/s]")


def test_force_is_named_only_where_it_helps(tmp_path, capsys):
    rows = [[cell for k, cell in enumerate(row) if k != 2] for row in rows_of(example("test_02"))]
    log = write_text(tmp_path / "log.csv", rows)
    assert proposed(log, tmp_path) == 2
    capsys.readouterr()
    assert imported(log, tmp_path, "--accept") == 2
    said = capsys.readouterr().err
    assert "lacks main.pressure_a" in said
    assert "nothing written" in said
    assert "--force" not in said


def test_a_slip_in_a_setting_is_told_as_such(tmp_path, capsys):
    """`key 'from' is missing` was all that was said."""
    log = write_text(tmp_path / "log.csv", rows_of(example("test_02")))
    assert proposed(log, tmp_path) == 0
    for setting, said in (
        ("hook_load.unti=t", "did you mean unit?"),
        ("hook_laod.unit=t", "the map has no channel 'hook_laod'"),
        ("rope_force.unit=kN", "--set rope_force.from=COLUMN"),
    ):
        assert imported(log, tmp_path, "--set", setting) == 2
        assert said in capsys.readouterr().err


def test_signals_of_one_run_in_two_files_are_to_be_joined(tmp_path, capsys):
    rows = rows_of(example("test_02"))
    one = write_text(tmp_path / "speed.csv", [row[:2] for row in rows])
    two = write_text(tmp_path / "pressures.csv", [[row[0], *row[2:]] for row in rows])
    assert (
        run(["import", str(one), str(two), "--propose", "--map", str(tmp_path / "m.yaml"), "--crane", "crane_150t"])
        == 2
    )
    assert "join them by time into one file first" in capsys.readouterr().err


def test_a_displacement_that_nobody_logs_may_be_constant(tmp_path, capsys):
    """Motors of constant displacement have no feedback; a column was asked for that no such winch has."""
    known = {channel: words for channel, words in GERMAN.items() if not channel.endswith("displacement")}
    log = write_text(tmp_path / "log.csv", rows_of(example("test_02"), known))
    words = ["import", str(log), "--propose", "--crane", "crane_150t", "--map", str(tmp_path / "m.yaml"), "--overwrite"]
    assert run(words) == 2
    hint = "main.displacement.constant=215 cm^3/rev"
    assert f"motors of constant displacement: --set '{hint}'" in capsys.readouterr().err
    assert run([*words, "--set", hint]) == 0
    assert "main.displacement <- 215 cm^3/rev, a constant\n" in capsys.readouterr().out


def test_a_column_of_the_right_name_without_a_number_is_said_to_have_none(tmp_path, capsys):
    """`no column found; not used are 'motor_speed [rpm]'` left one to wonder."""
    rows = ["time [s],motor_speed [rpm],main.pressure_a [bar],main.pressure_b [bar],main.displacement [cm^3/rev]"]
    rows += [f"{0.02 * k:.2f},nan,{120 + k % 3},25,215" for k in range(200)]
    (tmp_path / "log.csv").write_text("\n".join(rows))
    words = [
        "import",
        str(tmp_path / "log.csv"),
        "--propose",
        "--crane",
        "crane_150t",
        "--map",
        str(tmp_path / "m.yaml"),
    ]
    assert run(words) == 2
    assert "not used are 'motor_speed [rpm]' ('motor_speed [rpm]' without a number in it)" in capsys.readouterr().err


def test_of_a_position_it_is_said_that_its_speed_is_taken(tmp_path):
    log = tmp_path / "seapath.csv"
    for unit, said in (("m", True), ("m/s", False)):
        log.write_text(HEAVE.replace("heave [m]", f"heave [{unit}]"))
        (tmp_path / "map.yaml").unlink(missing_ok=True)
        assert proposed(log, tmp_path) == 0
        text = (tmp_path / "map.yaml").read_text()
        assert ("a position: its speed is taken" in text) is ("differentiate:" in text) is said
