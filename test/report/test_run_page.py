"""Runs as a page: every channel in numbers, in the unit that people read."""

import numpy as np
import pytest

from winch_friction.physics.signals import Run
from winch_friction.physics.winch.model_curve import model_curve
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import read_run
from winch_friction.report.run_page import _friction, channel_rows, run_plot, write_run_page

RUN = Run(
    "r",
    {
        "time": np.arange(4.0),
        "motor_speed": np.array([-10.0, 0.0, np.nan, 40.0]) * np.pi / 30.0,
        "main.pressure_a": np.array([1e7, 2e7, 3e7, np.nan]),
        "hook_load": np.array([np.nan, np.nan, 5e3, 7e3]),
    },
)


def test_range_mean_and_missing_samples_of_every_channel():
    rows = {row["channel"]: row for row in channel_rows(RUN)}
    shown = ("unit", "least", "largest", "mean", "missing [samples]")
    assert [rows["motor_speed"][key] for key in shown] == ["rpm", *map(pytest.approx, (-10.0, 40.0, 10.0)), 1]
    assert [rows["main.pressure_a"][key] for key in shown] == ["bar", *map(pytest.approx, (100.0, 300.0, 200.0)), 1]
    assert [rows["hook_load"][key] for key in shown] == ["t", *map(pytest.approx, (5.0, 7.0, 6.0)), 2]


@pytest.mark.parametrize(("begin", "unit", "least"), [(0.0, "s", 0.0), (7.5, "s", 7.5), (1.7e9, None, 0.0)])
def test_a_time_has_no_mean_and_counts_from_its_date(begin, unit, least):
    """`plot` said 1.7e+09 s of the least, the largest and the mean; and -3e-16 rpm of a winch that goes to and fro."""
    swing = np.sin(np.pi * np.arange(200) / 100.0)
    time, speed = channel_rows(Run("r", {"time": begin + np.arange(200.0), "motor_speed": swing}))
    assert time["unit"] == (unit or "s from 2023-11-14 22:13 UTC")
    assert (time["least"], time["largest"], np.isnan(time["mean"])) == (least, least + 199.0, True)
    assert swing.mean() != 0.0
    assert speed["mean"] == 0.0
    rope = Run("r", {"time": np.arange(200.0), "motor_speed": swing + 1e-3})
    assert channel_rows(rope)[1]["mean"] == pytest.approx(1e-3 * 30.0 / np.pi)


def test_what_is_drawn_is_in_the_unit_of_its_label():
    columns = run_plot(RUN).frames[0].columns
    assert columns["main.pressure_a [bar]"][:3] == pytest.approx([100.0, 200.0, 300.0])
    assert columns["hook_load [t]"][2:] == pytest.approx([5.0, 7.0])


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize(
    ("broken", "mean"), [("1e99", 1e99 / 15 / 1e5), ("1e300", 20.0), ("1.5e308", 20.0), ("-1e308", 20.0)]
)  # beyond 1e100 it is none
def test_a_value_that_no_sensor_can_mean_is_drawn_without_a_warning_of_the_libraries(tmp_path, broken, mean):
    header = "time,motor_speed [rpm],main.pressure_a [bar],main.pressure_b,main.displacement [cm^3/rev],hook_load\n"
    rows = (f"{0.1 * k},{60 + k},150,{broken if k in (2, 3) else 2e6},215,55e3\n" for k in range(30))
    (tmp_path / "r.csv").write_text(header + "".join(rows))
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    run = read_run(tmp_path / "r.csv", crane)
    shown = next(row["mean"] for row in channel_rows(run) if row["channel"] == "main.pressure_b")
    assert shown == pytest.approx(mean)
    assert write_run_page(tmp_path / "page.html", [run], crane, model).is_file()


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_value_that_its_unit_takes_beyond_all_numbers_is_missing(tmp_path):
    (tmp_path / "r.csv").write_text("time,motor_speed,motor_torque [kN*m]\n0,1,1e308\n1,1,2\n2,1,3\n")
    run = read_run(tmp_path / "r.csv")
    assert np.isnan(run["motor_torque"]).tolist() == [True, False, False]
    assert "1 of 3 values is not a number, line 2" in run.warnings[0]


def test_one_run_is_one_run(tmp_path):
    assert "1 run<" in write_run_page(tmp_path / "one.html", [RUN], None, None).read_text()


def test_channels_of_one_kind_and_unit_share_a_panel_and_the_models_friction_has_its_own():
    run = Run("r.csv", {
        "time": 50.0 + np.arange(3.0), "motor_speed": np.full(3, np.pi), "speed_reference": np.full(3, 2.0 * np.pi),
        "main.pressure_a": np.full(3, 1e7), "main.pressure_b": np.full(3, 2e7), "oil_temperature": np.full(3, np.nan),
    })  # fmt: skip
    plot = run_plot(run, np.array([7.0, 8.0, 9.0]))
    columns = plot.frames[0].columns
    assert list(plot.rows) == ["speed [rpm]", "pressure [bar]", "friction [N·m]"]
    assert {line.label: (line.row, line.role, columns[line.y][0]) for line in plot.lines} == {
        "motor speed": (0, "plain", pytest.approx(30.0)), "speed reference": (0, "plain", pytest.approx(60.0)),
        "main.pressure a": (1, "plain", pytest.approx(100.0)), "main.pressure b": (1, "plain", pytest.approx(200.0)),
        "model's friction": (2, "after", 7.0),
    }  # fmt: skip
    assert columns["time [s]"].tolist() == [0.0, 1.0, 2.0]
    assert plot.caption == "r.csv, 3 samples"


def test_the_models_friction_of_a_run_is_that_at_its_own_operating_point(crane_150t, crane2_model):
    """At 55 t with constant speed it is that of the model's curve there."""
    speed, count = 60.0, 50
    curve = model_curve(crane2_model, crane_150t, load=55e3, speed=[speed])
    known_of = {"pressure_a": curve.pressure[0] + 2e6, "pressure_b": 2e6, "displacement": crane_150t.max_displacement}
    groups = {f"main.{name}": np.full(count, value) for name, value in known_of.items()}
    columns = {"time": 0.1 * np.arange(count), "motor_speed": np.full(count, speed), "hook_load": np.full(count, 55e3)}
    known = _friction(Run("r", columns | groups), crane_150t, crane2_model)
    expected = curve.torque[0]
    assert known[count // 2] == pytest.approx(expected, rel=0.02)
    assert (
        _friction(Run("r", {k: v for k, v in (columns | groups).items() if k != "hook_load"}), crane_150t, crane2_model)
        is None
    )
