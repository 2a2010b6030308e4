"""Reading a supplier's table: units, efficiency and torque, ranges, and every defect in one line."""

import numpy as np
import pytest

from campaign.supplier_generator import TABLE_1, write_supplier_table
from winch_friction.cli.main import run
from winch_friction.identification.black_box import BlackBoxMap
from winch_friction.identification.motor_identification import identify_motor
from winch_friction.identification.supplier_file import read_supplier_table
from winch_friction.identification.supplier_table import FitRange
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError

HEADER = "speed [rpm],pressure [bar],displacement [cm^3/rev],efficiency [%]"


@pytest.fixture
def write(tmp_path):
    def to_file(*lines):
        path = tmp_path / "table.csv"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return path

    return to_file


def test_efficiency_becomes_torque_loss(write):
    table = read_supplier_table(write("# a comment", HEADER, "1000,200,215,94.0", "2000,100,107.5,90"))
    np.testing.assert_allclose(table.speed, [1000 * RPM, 2000 * RPM])
    nominal = np.array([200 * BAR * 215, 100 * BAR * 107.5]) * CM3_PER_REV
    np.testing.assert_allclose(table.torque_loss, nominal * [0.06, 0.10])
    assert table.max_displacement == pytest.approx(215 * CM3_PER_REV)


def test_other_units_and_torque(write):
    path = write("speed [rad/s],pressure [MPa],displacement [m^3/rad],torque [kN*m]", "100,20,3.0e-5,0.56")
    assert read_supplier_table(path).torque_loss == pytest.approx([40.0])


@pytest.mark.parametrize("separator", [";", "\t"])
def test_other_separators_as_in_run_files(write, separator):
    lines = ("# speed, pressure, displacement; then the loss", HEADER, "1000,200,215,94.0", "2000,100,107.5,90")
    table = read_supplier_table(write(lines[0], *(line.replace(",", separator) for line in lines[1:])))
    np.testing.assert_allclose(table.pressure, [200 * BAR, 100 * BAR])


def test_loss_in_si_without_brackets_and_weights(write):
    table = read_supplier_table(write("speed,pressure,displacement,torque_loss,weight", "100,2e7,3e-5,17,2.5"))
    assert table.torque_loss == pytest.approx([17.0])
    np.testing.assert_allclose(table.fit_data("column").weight, [2.5])


BAD = {
    "missing column": (["speed [rpm],pressure [bar],efficiency [%]", "1000,200,90"],
                       r"column 'displacement' is missing"),
    "unknown unit": (["speed [furlongs],pressure [bar],displacement [cm^3/rev],efficiency [%]", "1,2,3,90"],
                     r"column 'speed': unit 'furlongs'"),
    "a volume without its angle": (["speed [rpm],pressure [bar],displacement [cm^3],efficiency [%]", "1,2,3,90"],
                                   r"column 'displacement': unit 'cm\^3' cannot be read as m\^3/rad"),
    "efficiency above 1": ([HEADER, "1000,200,215,94", "1000,200,215,102"],
                           r"row 3: column 'efficiency' = 102 is above 1"),
    "NaN": ([HEADER, "1000,nan,215,94"], r"row 2: column 'pressure' holds 'nan', not a finite number"),
    "text": ([HEADER, "1000,200,215,n/a"], r"row 2: column 'efficiency' holds 'n/a'"),
    "underscore": ([HEADER, "1_000,200,215,94"], r"row 2: column 'speed' holds '1_000', not a finite number"),
    "decimal comma": ([HEADER.replace(",", ";"), "1000;200;215;94,5"],
                      r"row 2: column 'efficiency' holds '94,5', not a finite number; write it with a point"),
    "empty cell": ([HEADER, "1000,,215,94"], r"row 2: column 'pressure' is empty; give a number"),
    "cells": ([HEADER, "1000,200,215"], r"row 2: 3 cells, the header has 4 columns"),
    "negative": ([HEADER, "-1000,200,215,94"], r"row 2: column 'speed' = -1000 must be above 0"),
    "a speed that no motor has": ([HEADER, "1e300,200,215,94"],
                                  r"row 2: column 'speed' = 1e300 is no motor's: .* 2.865e\+04 rpm"),
    "a pressure that overflows": ([HEADER, "1000,1e308,215,94"],
                                  r"row 2: column 'pressure' = 1e308 is no motor's: .* 2000 bar"),
    "a displacement next to none": ([HEADER, "1000,200,1e-200,94"],
                                    r"row 2: column 'displacement' = 1e-200 is no motor's: .* 3.77e\+05 cm\^3/rev"),
    "a torque that no motor has": ([HEADER.replace("efficiency [%]", "torque [N*m]"), "1000,200,215,-1e300"],
                                   r"row 2: column 'torque' = -1e300 is no motor's: -1e\+06 ... 1e\+06 N\*m"),
    "a weight beyond all others": ([HEADER + ",weight", "1000,200,215,94,1e200"],
                                   r"row 2: column 'weight' = 1e200 must be 1e-09 ... 1e\+09"),
    "no loss": (["speed [rpm],pressure [bar],displacement [cm^3/rev]", "1,2,3"], r"exactly one of the columns"),
    "two losses": (["speed [rpm],pressure [bar],displacement [cm^3/rev],efficiency [%],torque [N*m]", "1,2,3,90,1"],
                   r"found efficiency and torque"),
    "torque above nominal": (["speed [rpm],pressure [bar],displacement [cm^3/rev],torque [N*m]", "1000,100,215,400"],
                             r"row 2: column 'torque' = 400 is above D dp"),
    "header only": ([HEADER], r"a header and at least one row"),
    "column twice": (["speed [rpm],speed [rpm],pressure [bar],displacement [cm^3/rev],efficiency [%]", "1,1,2,3,90"],
                     r"column 'speed' appears twice"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_line_with_the_file(write, case):
    lines, message = BAD[case]
    with pytest.raises(InputError, match=message) as caught:
        read_supplier_table(write(*lines))
    assert "table.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "latin-1"])
def test_a_table_in_another_encoding_is_to_be_saved_as_utf_8(write, encoding):
    path = write("")
    path.write_bytes(f"# größte\n{HEADER}\n1000,200,215,94\n".encode(encoding))
    with pytest.raises(InputError, match=r"table.csv: not UTF-8 text \(.*\); save it as UTF-8$"):
        read_supplier_table(path)


@pytest.mark.parametrize("motor", sorted(TABLE_1))
def test_the_usual_range_of_the_papers_motors_is_the_papers(tmp_path, motor):
    table = read_supplier_table(write_supplier_table(tmp_path / "t.csv", motor))
    np.testing.assert_array_equal(FitRange.usual(table).select(table).speed, FitRange().select(table).speed)


@pytest.mark.parametrize(
    ("stroke", "fastest"), [(45.0, 5000.0), (28.0, 2500.0), (5000.0, 60.0)], ids=["small", "smallest", "radial"]
)
def test_a_small_or_slow_motor_has_rows_in_the_usual_range(write, stroke, fastest):
    """A practice with a motor of 45 cm^3/rev, or of a radial piston motor of 60 rpm, could not be identified."""
    rows = [
        f"{share * fastest},{bar},{part * stroke},{90.0 + 5.0 * share * part - 0.004 * bar}"
        for share in (0.1, 0.3, 0.6, 0.8, 1.0) for bar in (100, 200, 300) for part in (0.2, 0.4, 0.7, 1.0)
    ]  # fmt: skip
    table = read_supplier_table(write(HEADER, *rows))
    inside = FitRange.usual(table).select(table)
    assert inside.displacement.min() < 0.5 * table.max_displacement
    assert inside.speed.min() < 0.5 * inside.speed.max()
    assert identify_motor(table, ["mj4"], with_complex=False).chosen.name == "mj4"


def test_range_is_inclusive_and_refuses_to_leave_nothing(write):
    table = read_supplier_table(write(HEADER, "400,50,50,70", "2500,350,215,90", "2501,200,215,90", "300,200,215,90"))
    assert len(FitRange().select(table)) == 2
    with pytest.raises(InputError, match="no row lies inside the range"):
        FitRange(speed=(1.0, 2.0)).select(table)


def test_nominal_weights_make_efficiency_errors_alike(write):
    data = read_supplier_table(write(HEADER, "1000,50,50,80", "1000,350,215,95")).fit_data("nominal")
    ratio = (350 * 215) ** 2 / (50 * 50) ** 2
    assert data.weight[0] / data.weight[1] == pytest.approx(ratio)
    with pytest.raises(InputError, match="weighting 'twice' is not known"):
        read_supplier_table(write(HEADER, "1000,50,50,80")).fit_data("twice")


@pytest.mark.parametrize("complete", [True, False])
def test_map_returns_the_table_and_interpolates_linearly(write, complete):
    rows = [
        f"{n},{p},{d},{5 + 0.01 * n + 0.02 * p + 0.03 * d}"
        for n in (500, 1000, 2000)
        for p in (100, 200, 300)
        for d in (50, 100, 200)
        if complete or (n, p, d) != (2000, 300, 200)
    ]
    table = read_supplier_table(write(HEADER.replace("efficiency [%]", "torque_loss [N*m]"), *rows))
    black_box = BlackBoxMap(table)
    np.testing.assert_allclose(
        black_box.torque_loss(table.speed, table.pressure, table.displacement), table.torque_loss, rtol=1e-9
    )
    between = black_box.torque_loss(
        np.array([750 * RPM]), np.array([150 * BAR]), np.array([75 * CM3_PER_REV])
    )  # the loss is a plane in the three axes
    assert between == pytest.approx([5 + 7.5 + 3.0 + 2.25])
    outside = np.array([2500 * RPM]), np.array([150 * BAR]), np.array([75 * CM3_PER_REV])
    assert black_box.outside(*outside).all()
    assert np.isfinite(black_box.torque_loss(*outside)).all()


def test_the_largest_displacement_is_the_tables_unless_it_is_said(write):
    path = write(HEADER, "1000,200,160,94.0")
    assert read_supplier_table(path).max_displacement == pytest.approx(160 * CM3_PER_REV)
    assert read_supplier_table(path, 215 * CM3_PER_REV).max_displacement == pytest.approx(215 * CM3_PER_REV)


@pytest.mark.parametrize("complete", [True, False])
def test_the_map_of_a_motor_that_does_not_swing_has_two_axes(write, complete):
    rows = [
        f"{n},{p},160,{5 + 0.01 * n + 0.02 * p}"
        for n in (500, 1000, 2000)
        for p in (100, 200, 300)
        if complete or (n, p) != (2000, 300)
    ]
    black_box = BlackBoxMap(read_supplier_table(write(HEADER.replace("efficiency [%]", "torque_loss [N*m]"), *rows)))
    speed, pressure = np.full(2, 750 * RPM), np.full(2, 150 * BAR)
    displacement = np.array([160.5, 120.0]) * CM3_PER_REV
    assert black_box.torque_loss(speed, pressure, displacement)[0] == pytest.approx(5 + 7.5 + 3.0)
    assert black_box.outside(speed, pressure, displacement).tolist() == [False, True]
    assert black_box.outside(4.0 * speed, pressure, displacement).all()


def test_rows_outside_the_range_of_the_fit_are_said(tmp_path, capsys):
    """Half a fast motor's table was left out without a word."""
    rows = [f"{n},{p},{d},{90 - n / 1000 - d / 100}" for n in (500, 1000, 2000, 4000, 6000) for p in (100, 200, 300)
            for d in (20, 30, 45)]  # fmt: skip
    path = tmp_path / "fast.csv"
    head = "speed [rpm],pressure [bar],displacement [cm^3/rev],efficiency [%]"
    path.write_text("\n".join([head, *rows]))
    fit = ["identify", "motor", str(path), "--out", str(tmp_path / "m.yaml"), "--no-complex", "--overwrite"]
    assert run([*fit]) == 0
    said = capsys.readouterr().err
    assert "fast.csv: 18 of 45 rows are left out: 18 by speed (400 ... 2500 rpm count)" in said
    assert run([*fit, "--speed", "400-6000"]) == 0
    assert "left out" not in capsys.readouterr().err


def test_outside_a_map_the_nearest_row_holds_by_what_the_axes_span(write):
    """A step of an axis counts by its share of the largest value, whatever its unit; a sign counts for nothing."""
    rows = [
        f"{n},{p},{d},{n / 1000 + p / 10 + d / 10}"
        for n in (500, 1000, 2000)
        for p in (100, 200, 300)
        for d in (50, 100)
    ]
    black_box = BlackBoxMap(read_supplier_table(write(HEADER.replace("efficiency [%]", "torque_loss [N*m]"), *rows)))

    def loss(speed, pressure, displacement):
        at = speed * RPM, pressure * BAR, displacement * CM3_PER_REV
        return float(black_box.torque_loss(*(np.array([each]) for each in at))[0])

    assert loss(2500, 100, 50) == pytest.approx(2 + 10 + 5)
    assert loss(2500, 290, 95) == pytest.approx(2 + 30 + 10)
    assert loss(100, 340, 60) == pytest.approx(0.5 + 30 + 5)
    inside = loss(1000, 250, 75)
    assert inside == pytest.approx(1 + 25 + 7.5)
    assert loss(-1000, 250, 75) == loss(1000, -250, 75) == inside


@pytest.mark.parametrize(("part", "axes"), [(0.985, 2), (0.95, 3)])
def test_displacements_that_differ_by_two_per_cent_are_one(write, part, axes):
    """As a feedback shows those of a motor that does not swing."""
    rows = [f"{n},{p},{160 * share},5" for n in (500, 1000) for p in (100, 200) for share in (1.0, part)]
    table = read_supplier_table(write(HEADER.replace("efficiency [%]", "torque_loss [N*m]"), *rows))
    assert BlackBoxMap(table)._varied.tolist() == [True, True, axes == 3]
