"""Motor groups named in a row above the names, over merged cells: each name stood twice and was asked about."""

import pytest
from importing.logs import example, same, write_text, write_workbook

from winch_friction.cli.main import run
from winch_friction.importing.group_names import with_groups
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.records.runs import read_run

NAMES = ["Time [s]", "Speed [rpm]", "Load [t]"]
OF_GROUP = ["Pressure A [bar]", "Pressure B [bar]", "Displacement [cm3/rev]"]


def rows_of_a_compensation():
    """Names over which groups stand, and the rows of a run in active compensation."""
    base = example("ahc_160")
    columns = [base.time, base["motor_speed"] / RPM, base["hook_load"] / 1e3]
    for group in ("active", "passive"):
        columns += [base[f"{group}.pressure_a"] / 1e5, base[f"{group}.pressure_b"] / 1e5]
        columns += [base[f"{group}.displacement"] / CM3_PER_REV]
    above = ["", "Winch", "", "Active motors", "", "", "Passive motors", "", ""]
    return base, above, [[f"{x:.4f}" for x in row] for row in zip(*columns, strict=True)]


@pytest.mark.parametrize("kind", ["text", "workbook"])
def test_groups_above_the_names_tell_them_apart(kind, tmp_path, capsys):
    base, above, body = rows_of_a_compensation()
    head = [above, [*NAMES, *OF_GROUP, *OF_GROUP]]
    if kind == "text":
        log = write_text(tmp_path / "log.csv", [*head, *body])
    else:
        merged = [[cell or None for cell in above], head[1]]  # the other cells of a merged one are empty
        log = write_workbook(tmp_path / "log.xlsx", [*merged, *([float(x) for x in row] for row in body)])
    where = ["import", str(log), "--map", str(tmp_path / "map.yaml"), "--out", str(tmp_path / "runs")]
    assert run([*where, "--propose", "--crane", "crane_150t"]) == 0, capsys.readouterr().err
    assert run(where) == 0, capsys.readouterr().err
    written = read_run(tmp_path / "runs" / "log.csv")
    assert same(written, base, [c for c in base.columns if "." in c])
    assert not same(written, base, ["active.pressure_a"], rounding=0.0)  # to the log's digits, no better


def test_names_that_stand_once_keep_them():
    above = ["Winch", "", "Active", "", "Passive", ""]
    names = ["n", "m", "pA", "pB", "pA", "pB"]
    assert with_groups(names, above) == ["n", "m", "Active pA", "Active pB", "Passive pA", "Passive pB"]


@pytest.mark.parametrize(
    "above",
    [(), ["Report of the crane", "", "", ""], ["Report", "", "", "A"], ["A", "A", "B", "B"], ["", "", "", ""]],
    ids=["none", "a title", "one group", "still alike", "empty"],
)
def test_what_tells_nothing_apart_is_no_group(above):
    names = ["p", "p", "p", "p"]
    assert with_groups(names, above) == names
