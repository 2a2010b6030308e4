"""Numbers that are tenths or shares: a controller's bar in tenths was taken for psi, a speed in % could not be said."""

from types import SimpleNamespace

import numpy as np
import pytest
from importing.logs import EXAMPLES, GERMAN, example, rows_of, same, write_text

from winch_friction.cli.main import run
from winch_friction.importing import orientation
from winch_friction.importing.carry_out import _default_share
from winch_friction.importing.units import conversion, fitting_si_unit, is_share
from winch_friction.physics.errors import InputError
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import read_run

PRESSURES = ("main.pressure_a", "main.pressure_b")


def words_of(**changed):
    """The German words with some replaced: channel (dots as __) = (header, factor, digits)."""
    return GERMAN | {name.replace("__", "."): word for name, word in changed.items()}


@pytest.fixture
def imported(tmp_path, capsys):
    """What `import` makes of rows: the status, what it said, the run's file."""

    def ask(rows, *settings):
        log = write_text(tmp_path / "log.csv", rows)
        where = ["import", str(log), "--map", str(tmp_path / "map.yaml"), "--out", str(tmp_path / "runs")]
        where += [*(x for s in settings for x in ("--set", s)), "--overwrite"]
        status = run([*where, "--propose", "--crane", "crane_150t"]) or run(where)
        return status, capsys.readouterr(), tmp_path / "runs" / "log.csv"

    return ask


def bare_hook():
    """The shipped test with the lightest load: its balance tells a gain of 1.45 from none hardly at all."""
    runs = [example(path.stem) for path in sorted(EXAMPLES.glob("test_*.parquet"))]
    return min(runs, key=lambda each: each["hook_load"].max())


def test_tenths_of_a_bar_without_a_unit_are_not_psi(imported):
    tenths = words_of(main__pressure_a=("Druck A", 1e-4, 0), main__pressure_b=("Druck B", 1e-4, 0))
    light = bare_hook()
    status, said, written = imported(rows_of(light, tenths))
    assert status == 2, said.out
    assert "psi" in said.err
    assert "0.1 bar" in said.err
    status, said, written = imported(rows_of(light, tenths), *(f"{name}.unit=0.1 bar" for name in PRESSURES))
    assert status == 0, said.err
    assert same(read_run(written), light, PRESSURES, rounding=1e-2)


def test_a_row_of_units_says_tenths_with_a_comma(imported):
    heads = words_of(main__pressure_a=("Druck A", 1e-4, 0), main__pressure_b=("Druck B", 1e-4, 0))
    rows = rows_of(example("test_02"), heads)
    units = ["", *(h.partition("[")[2].rstrip("]") or "0,1 bar" for h in rows[0][1:])]
    units[-1] = "-"
    rows = [[h.partition(" [")[0] for h in rows[0]], units, *rows[1:]]
    status, said, written = imported(rows)
    assert status == 0, said.err
    assert same(read_run(written), example("test_02"), PRESSURES)


def test_a_displacement_as_a_volume_is_that_of_a_revolution():
    assert conversion("displacement", "cm³", "").scale == pytest.approx(conversion("displacement", "ccm", "").scale)
    assert fitting_si_unit("displacement", "cm^3") == "m^3/rad"
    assert fitting_si_unit("wire_out", "cm^3") is None


def test_a_speed_in_percent_is_asked_of_what_and_taken_so(imported):
    share = words_of(motor_speed=("Motordrehzahl [%]", 60.0 / (2.0 * np.pi) / 20.0, 4))
    status, said, written = imported(rows_of(example("test_02"), share))
    assert status == 2
    assert "of what? --set 'motor_speed.of=NUMBER rpm'" in said.err
    status, said, written = imported(rows_of(example("test_02"), share), "motor_speed.of=2000 rpm")
    assert status == 0, said.err
    assert same(read_run(written), example("test_02"), ["motor_speed"])


def test_a_share_needs_what_it_is_of():
    assert is_share("motor_speed", "%")
    assert not is_share("motor_speed", "rpm")
    assert not is_share("wire_layer", "-")
    with pytest.raises(InputError, match="is a share; say of what"):
        conversion("drum_speed", "%", "drum_speed")


def test_a_fans_speed_in_percent_is_no_channel(imported):
    """Beside the drum's speed it was asked of what the fan's was."""
    drum = words_of(motor_speed=("Trommeldrehzahl [1/min]", 60.0 / (2.0 * np.pi) / 250.0, 6))
    rows = rows_of(example("test_02"), drum)
    rows = [[*row, str(40 + k % 7) if k else "Blower speed [%]"] for k, row in enumerate(rows)]
    status, said, written = imported(rows)
    assert status == 0, said.err
    assert "not used: Blower speed [%]" in said.out
    assert read_run(written, load_crane("crane_150t"))["motor_speed"] == pytest.approx(
        example("test_02")["motor_speed"], abs=0.05
    )


def test_a_share_is_by_itself_of_the_cranes_largest_displacement_alone():
    crane = load_crane("crane_150t")
    assert _default_share("displacement", crane) == crane.max_displacement
    assert np.isnan([_default_share("motor_speed", crane), _default_share("displacement", None)]).all()


@pytest.mark.parametrize(("after", "turned"), [(4.9, True), (5.1, False)])
def test_a_negative_displacement_is_turned_where_that_halves_the_misfit(monkeypatch, after, turned):
    misfits = iter([10.0, after])
    monkeypatch.setattr(orientation, "_mean_mismatch", lambda _: next(misfits))
    draft = SimpleNamespace(log_map="as it was", converted=lambda: [SimpleNamespace(columns={"d": -np.ones(3)})])
    draft.change = lambda name, sign, because: setattr(draft, "log_map", (name, sign))
    orientation._settle_displacement(draft, "d")
    assert draft.log_map == (("d", -1) if turned else "as it was")
