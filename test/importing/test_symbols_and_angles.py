"""Symbols of formulas as names, angles for displacements, one pressure for two, a time of too few digits."""

import numpy as np
import pytest
from importing.logs import example

from winch_friction.importing.carry_out import import_log
from winch_friction.importing.propose import propose
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.records.crane_file import load_crane

CRANE = load_crane("crane_150t")
RUN = example("test_05")
SYMBOLS = {"t [s]": RUN.time, "n_mot_rpm": RUN["motor_speed"] / RPM, "pA_bar": RUN["main.pressure_a"] / BAR,
           "pB_bar": RUN["main.pressure_b"] / BAR, "V_g [cm3]": RUN["main.displacement"] / CM3_PER_REV,
           "m_t": RUN["hook_load"] / 1e3}  # fmt: skip


def proposed(folder, columns, *settings, digits=9):
    path = folder / "log.csv"
    rows = "\n".join(",".join(f"{value:.{digits}g}" for value in row) for row in zip(*columns.values(), strict=True))
    path.write_text(",".join(columns) + "\n" + rows + "\n", encoding="utf-8")
    return path, propose([path], CRANE, settings=list(settings))


def test_symbols_of_formulas_are_the_channels_that_they_stand_for(tmp_path):
    path, found = proposed(tmp_path, SYMBOLS)
    assert not found.problems
    run = import_log(path, found.log_map, CRANE)
    assert run["main.displacement"] == pytest.approx(RUN["main.displacement"], rel=1e-6)
    assert run["hook_load"] == pytest.approx(RUN["hook_load"], rel=1e-6)
    assert "oil_temperature" not in run  # the t of m_t is tonnes


def test_a_letter_is_no_oil_by_itself_and_one_beside_oil_or_a_unit_is(tmp_path):
    for name, taken in (("T", False), ("T_oil", True), ("T [degC]", True)):
        _, found = proposed(tmp_path, {**SYMBOLS, name: np.full(len(RUN), 40.0)})
        assert ("oil_temperature" in found.log_map.columns) == taken, name


def test_the_angle_of_a_swash_plate_is_no_shafts_and_the_person_is_told_what_to_make_of_it(tmp_path):
    columns = {("Swash angle [deg]" if name.startswith("V_g") else name): each for name, each in SYMBOLS.items()}
    columns["Swash angle [deg]"] = np.full(len(RUN), 17.0)
    _, found = proposed(tmp_path, columns)
    assert "shaft_angle" not in found.log_map.columns
    assert "'Swash angle [deg]' is an angle: add a column of the displacement that it sets" in found.problems[0]
    _, answered = proposed(tmp_path, columns, "main.displacement.from=Swash angle [deg]", "main.displacement.unit=deg")
    assert "main.displacement: unit 'deg' is no unit of displacement" in answered.problems[0]


def test_a_pressure_drop_alone_is_imported_beside_a_constant(tmp_path):
    columns = {name: each for name, each in SYMBOLS.items() if not name.startswith("p")}
    columns["Differential pressure [bar]"] = SYMBOLS["pA_bar"] - SYMBOLS["pB_bar"]
    _, found = proposed(tmp_path, columns)
    assert found.problems[0].endswith("pressure drop A - B alone: --set 'main.pressure_b.constant=0 bar'")
    path, answered = proposed(tmp_path, columns, "main.pressure_b.constant=0 bar")
    run = import_log(path, answered.log_map, CRANE)
    drop = RUN["main.pressure_a"] - RUN["main.pressure_b"]
    assert run["main.pressure_a"] - run["main.pressure_b"] == pytest.approx(drop, rel=1e-6)


def test_a_time_of_too_few_digits_does_not_go_back_by_nothing(tmp_path):
    columns = {**SYMBOLS, "t [s]": 1.7e9 + RUN.time}
    _, found = proposed(tmp_path, columns, digits=6)
    assert found.problems[0].startswith("time: 't [s]' stands still in 100 % of the rows: written with too few digits?")


def test_a_unit_that_nobody_knows_is_asked_and_not_guessed_without_a_word(tmp_path):
    columns = {("Load [fass]" if name == "m_t" else name): each for name, each in SYMBOLS.items()}
    _, found = proposed(tmp_path, columns)
    assert found.problems == (
        "hook_load: 'Load [fass]' says 'fass', which is no unit that is known here; t is guessed from its size: set "
        "hook_load.unit",
    )
    assert not proposed(tmp_path, columns, "hook_load.unit=t")[1].problems


NAMES = [("Load [PT101]", 1.0), ("Load (port side)", 1.0), ("Load [sh tn]", 0.90718474)]


@pytest.mark.parametrize(("name", "factor"), NAMES)
def test_a_tag_and_a_remark_are_no_unit_and_short_tons_are_one(tmp_path, name, factor):
    columns = {key: each for key, each in SYMBOLS.items() if key != "m_t"} | {name: SYMBOLS["m_t"] / factor}
    path, found = proposed(tmp_path, columns)
    assert not found.problems
    assert import_log(path, found.log_map, CRANE)["hook_load"] == pytest.approx(RUN["hook_load"], rel=1e-6)
