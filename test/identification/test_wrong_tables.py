"""A supplier's table that is well formed and not what its headers say: told with every row, before it is a model."""

import pytest

from winch_friction.identification.supplier_file import read_supplier_table
from winch_friction.identification.supplier_table import FitRange
from winch_friction.physics.errors import InputError

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
