"""A supplier's table that is well formed and not what its headers say: told with every row, before it is a model."""

import math

import numpy as np
import pytest

from winch_friction.identification.supplier_file import is_supplier_table, read_supplier_table
from winch_friction.identification.supplier_table import FitRange, SupplierTable, motor_points
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.compiled import ORDER
from winch_friction.physics.friction.symbols import GROUP_SIGNALS

AXES = "speed [rpm],pressure [bar],displacement [cm^3/rev]"
ROWS = [(n, p, d) for n in (500, 1500, 2500) for p in (50, 200, 350) for d in (40, 107)]


@pytest.fixture
def read(tmp_path):
    def made(column, value, axes=AXES):
        rows = [f"{n},{p},{d},{value(n, p, d)}" for n, p, d in ROWS]
        (tmp_path / "table.csv").write_text("\n".join([f"{axes},{column}", *rows]))
        return read_supplier_table(tmp_path / "table.csv")

    return made


def nominal(p, d):
    return p * d / 62.83185


def lost(n, p, d):
    return 4.0 + 0.002 * n + 0.03 * nominal(p, d)


WRONG = {
    "what reaches the shaft": ("torque_loss [N*m]", lambda n, p, d: nominal(p, d) - lost(n, p, d), "name it 'torque'"),
    "what is lost": ("torque [N*m]", lost, "name it 'torque_loss'"),
    "newton centimetres": ("torque_loss [N*m]", lambda n, p, d: 100.0 * lost(n, p, d), "correct the unit"),
    "a loss in per cent": ("efficiency [%]", lambda n, p, d: 100.0 * lost(n, p, d) / nominal(p, d), "not what is"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_a_motor_that_loses_most_of_its_torque_is_a_wrong_column(read, case):
    """Fitted without a word: K3 = 0.2, and a friction of the whole torque."""
    column, value, said = WRONG[case]
    with pytest.raises(InputError, match=said) as caught:
        read(column, value)
    assert "row 7: column" in str(caught.value)
    assert "of the largest torque D dp, 596" in str(caught.value)


def test_the_right_columns_are_read_alike(read):
    tables = [read("torque_loss [N*m]", lost), read("torque [N*m]", lambda n, p, d: nominal(p, d) - lost(n, p, d)),
              read("efficiency", lambda n, p, d: 1.0 - lost(n, p, d) / nominal(p, d))]  # fmt: skip
    for table in tables:
        assert table.torque_loss == pytest.approx(tables[0].torque_loss, rel=1e-4)


def test_every_wrong_row_is_told_at_once(read):
    """The first row alone was, and the second kind after the first was mended."""
    with pytest.raises(InputError) as caught:
        read("efficiency [%]", lambda n, p, d: 109.0 if p == 50 else -3.0 if n == 2500 else 90.0)
    above, below = caught.value.problems
    assert "row 2: column 'efficiency' = 109.0 is above 1 (100 %)" in above
    assert above.endswith("; the same in row 3, 8, 9 and 2 more")
    assert "row 16: column 'efficiency' = -3.0 is not above 0" in below


def test_a_refused_number_is_told_with_the_unit_of_its_header(read):
    with pytest.raises(InputError, match=r"'pressure' = 350 is no motor's: .* 2000 bar; .* the header \('MPa'\)"):
        read("torque_loss [N*m]", lost, AXES.replace("bar", "MPa"))


def test_a_range_that_leaves_nothing_says_where_the_table_lies(read):
    """Speeds without a unit are rad/s: nobody saw it."""
    table = read("torque_loss [N*m]", lost, AXES.replace(" [rpm]", ""))
    with pytest.raises(InputError, match=r"speed 4775 \.\.\. 2\.387e\+04 rpm \(400 \.\.\. 2500 count\)") as caught:
        FitRange().select(table)
    assert "a column without one is SI" in str(caught.value)


def test_two_losses_of_one_point_are_no_table(tmp_path):
    """Two motors' rows, or two efficiencies', in one file were averaged without a word: K3 became nine times itself."""
    rows = [f"{n},{p},{d},{e}" for e in (92.0, 87.0) for n, p, d in ROWS]
    path = tmp_path / "table.csv"
    path.write_text("\n".join([f"{AXES},efficiency [%]", *rows]))
    with pytest.raises(InputError) as caught:
        read_supplier_table(path)
    assert "row 20: the same speed, pressure and displacement as in row 2, and 5 % of D dp" in str(caught.value)
    assert "and 17 more such rows: two motors, or two kinds of efficiency?" in str(caught.value)


def test_a_point_that_was_measured_twice_is_no_other_motor(tmp_path):
    rows = [f"{n},{p},{d},{e}" for e in (92.0, 91.0) for n, p, d in ROWS]
    (tmp_path / "table.csv").write_text("\n".join([f"{AXES},efficiency [%]", *rows]))
    assert len(read_supplier_table(tmp_path / "table.csv")) == 36


@pytest.mark.parametrize(
    "text",
    ["n\\p,50,100\n400,89.5,91\n500,89,90\n", "Drehzahl [1/min],Druck [bar],Wirkungsgrad [%]\n400,50,89\n"],
    ids=["a map", "another language"],
)
def test_a_table_of_another_shape_is_told_in_one_line(tmp_path, text):
    (tmp_path / "table.csv").write_text(text)
    with pytest.raises(
        InputError, match="a map with a speed per row and a pressure per column needs a row per point"
    ) as e:
        read_supplier_table(tmp_path / "table.csv")
    assert len(e.value.problems) == 1
    assert "'displacement [cm^3/rev]'" in str(e.value)


def test_a_spreadsheet_is_told_as_one(tmp_path):
    """Its bytes were said to be no UTF-8, and to be saved as that."""
    (tmp_path / "table.xlsx").write_bytes(b"PK\3\4\xff")
    with pytest.raises(InputError, match=r"a spreadsheet; save it as \.csv"):
        read_supplier_table(tmp_path / "table.xlsx")


def test_wrong_axes_and_a_wrong_efficiency_are_told_together(tmp_path):
    rows = [f"{n},{p},{d},90" for n, p, d in ROWS]
    rows[3], rows[5] = rows[3].replace(",90", ",101"), rows[5].replace(",350,", ",-350,")
    path = tmp_path / "table.csv"
    path.write_text("\n".join([f"{AXES},efficiency [%]", *rows]))
    with pytest.raises(InputError) as caught:
        read_supplier_table(path)
    assert ["row 7" in each for each in caught.value.problems] == [True, False]
    assert "row 5: column 'efficiency'" in caught.value.problems[1]


@pytest.mark.parametrize(
    ("efficiency", "said"),
    [
        (0.09, r"column 'efficiency': 9 % at best is no motor's"),
        (0.11, r"column 'efficiency': 89 % of the largest torque D dp, 596\d? N\*m, would be lost"),
        (0.48, "52 % of the largest torque"),
        (0.52, ""),
        (1.0, ""),  # of a dream, but no slip of a table
    ],
)
def test_a_motor_keeps_half_of_its_largest_torque_and_a_tenth_of_any(read, efficiency, said):
    if said:
        with pytest.raises(InputError, match=said):
            read("efficiency", lambda n, p, d: efficiency)
    else:
        table = read("efficiency", lambda n, p, d: efficiency)
        assert table.torque_loss == pytest.approx((1.0 - efficiency) * table.nominal_torque)


@pytest.mark.parametrize(("share", "above"), [(1.0, False), (1.001, True)])
def test_a_torque_at_the_shaft_is_at_most_all_of_it(read, share, above):
    def torque(n, p, d):
        return repr(share * p * 1e5 * d * 1e-6 / (2.0 * math.pi))

    if above:
        with pytest.raises(InputError, match="is above D dp"):
            read("torque [N*m]", torque)
    else:
        assert read("torque [N*m]", torque).torque_loss == pytest.approx([0.0] * len(ROWS), abs=1e-6)


@pytest.mark.parametrize(
    ("column", "row", "said"),
    [
        ("speed", "0,200,107,90", "must be above 0"),
        ("pressure", "1500,0,107,90", "must be above 0"),
        ("efficiency", "1500,200,107,0", "is not above 0; leave such rows out"),
        ("displacement", "1500,200,1e-5,90", r"is no motor's: 0.000377 \.\.\. 3.77e\+05 cm\^3/rev; correct the number"),
    ],
)
def test_nothing_and_next_to_nothing_are_no_operating_point(tmp_path, column, row, said):
    path = tmp_path / "table.csv"
    path.write_text("\n".join([f"{AXES},efficiency [%]", "1500,200,40,90", row]))
    with pytest.raises(InputError, match=f"row 3: column '{column}' = .* {said}"):
        read_supplier_table(path)


def test_a_suppliers_table_is_known_by_its_head_whatever_its_ending_is_written_in(tmp_path):
    text = f"# of a motor\n\n{AXES.replace(',', ';')};torque_loss [N*m]\n"
    for name, content, known in (
        ("table.CSV", text, True),
        ("table.csv", text, True),
        ("table.txt", text, False),
        ("run.csv", "time,motor_speed\n", False),
        ("axes.csv", f"{AXES}\n", False),
        ("two.csv", "speed,pressure,efficiency\n", False),
        ("quoted.csv", '"speed","pressure","displacement","efficiency"\n', True),
        ("none.csv", "", False),
    ):
        (tmp_path / name).write_text(content)
        assert is_supplier_table(tmp_path / name) == known, name
    assert not is_supplier_table(tmp_path)
    assert not is_supplier_table(tmp_path / "nowhere.csv")


@pytest.mark.parametrize(
    ("fastest", "largest", "slowest", "least"),
    [(5000, 400, 400.0, 50.0), (2000, 100, 320.0, 29.4118), (60, 5000, 9.6, 50.0), (3000, 34, 400.0, 10.0)],
)
def test_the_usual_range_is_a_part_of_a_smaller_or_slower_motors_own(fastest, largest, slowest, least):
    """50 of 170 cm^3/rev and 400 of 2500 rpm; what is above has no part in it."""
    one = np.ones(2)
    speed, displacement = np.array([50.0, fastest]) * RPM, np.array([5.0, largest]) * CM3_PER_REV
    own = FitRange.usual(SupplierTable("t", speed, 1e7 * one, displacement, one, one, largest * CM3_PER_REV))
    assert own.speed == pytest.approx((slowest * RPM, 2500.0 * RPM))
    assert own.pressure == pytest.approx((50.0 * BAR, 350.0 * BAR))
    assert own.displacement == (pytest.approx(least * CM3_PER_REV, rel=1e-4), float("inf"))


def test_a_range_without_an_end_is_said_from_where_on():
    one = np.ones(3)
    speed, pressure = np.array([1000.0, 2000.0, 1000.0]) * RPM, np.array([100.0, 200.0, 400.0]) * BAR
    swept = np.array([40.0, 45.0, 49.0]) * CM3_PER_REV
    table = SupplierTable("t", speed, pressure, swept, one, one, swept[-1])
    assert FitRange().left_out(table) == (
        "t: 3 of 3 rows are left out: 1 by pressure (50 ... 350 bar count), "
        "3 by displacement (from 50 cm^3/rev on count)"
    )
    with pytest.raises(InputError) as caught:
        FitRange().select(table)
    assert "pressure 100 ... 400 bar (50 ... 350 count), displacement 40 ... 49 cm^3/rev (from 50 on count)" in str(
        caught.value
    )
    assert "speed" not in str(caught.value)


def test_the_rows_that_are_kept_keep_all_that_belongs_to_them():
    one, k = np.ones(4), np.arange(1.0, 5.0)
    table = SupplierTable("t", k, 1e7 * k, 1e-5 * k, 10.0 * k, 100.0 * k, 9.0)
    kept = table.where(np.array([False, True, False, True]))
    assert (len(kept), kept.name, kept.max_displacement) == (2, "t", 9.0)
    assert [each.tolist() for each in (kept.speed, kept.torque_loss, kept.weight)] == [[2, 4], [20, 40], [200, 400]]
    assert kept.displacement / 1e-5 == pytest.approx([2.0, 4.0])
    assert kept.pressure / 1e7 == pytest.approx([2.0, 4.0])
    close = SupplierTable("t", one, 1e7 * one, np.array([215.0, 214.0, 215.0, 215.0]) * CM3_PER_REV, one, one, 9.0)
    assert len(np.unique(close.fit_data().cluster[:, 0])) == len(np.unique(close.fit_data().group)) == 2


def test_a_motor_alone_turns_forward_under_its_pressure_with_nothing_on_the_drum():
    point = motor_points(np.array([50.0]), np.array([2e7]), np.array([3e-5]))
    named = dict(zip([*ORDER, "count", *(each.name for each in GROUP_SIGNALS[1:])], point, strict=False))
    assert (named["direction"], named["drum_torque"], named["motor_total"]) == (1.0, 0.0, 1.0)
    assert (named["speed"], named["pressure"], named["pressure_sum"], named["displacement"]) == (50.0, 2e7, 2e7, 3e-5)
