"""The practice's tables, figures and sentences: every number stands under its own heading, in its unit."""

import base64
import json
import re
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.identification.friction_curve import FrictionCurve
from winch_friction.identification.supplier_table import SupplierTable
from winch_friction.identification.verification import PressureCheck, TestError
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.records.model_file import load_model
from winch_friction.report import practice_joint, practice_motor, practice_system
from winch_friction.report.practice import summary_lines
from winch_friction.report.practice_look import curve_label, curves_html, label, name, shown
from winch_friction.report.practice_loops import _extremes, _loop_verdict, loop_html, map_derived_html
from winch_friction.report.practice_verification import _check_rows, _friction_html, percent_html

MODEL = load_model("a6vm215_crane2")


def tables(html):
    """Every table as its rows, head first, of plain cells."""
    cells = lambda row: [
        unescape(re.sub("<[^>]*>", "", each)) for each in re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row)
    ]
    return [
        [cells(row) for row in re.findall(r"<tr>(.*?)</tr>", each)] for each in re.findall(r"<table>.*?</table>", html)
    ]


def content(html):
    return json.loads(re.search(r'application/json">(.*?)</script></figure>', html)[1])


def drawn(html):
    """The lines of a figure in their order: label, x, y, panel, role."""
    found = content(html)
    numbers = lambda packed: np.frombuffer(base64.b64decode(packed), "<f4")
    return [
        (text, numbers(found["frames"][k]["columns"][x]), numbers(found["frames"][k]["columns"][y]), row, role)
        for text, x, y, k, row, role, *_ in found["lines"]
    ]


def curve(test="t_01.csv", displacement=200.0, load=5000.0, shift=0.0, speed=(10.0, 50.0)):
    """A test of ten motors; its friction is (5, 6) bar times the displacement, beside `shift` bar."""
    up, down = np.array([205.0, 207.0]) * BAR, np.array([195.0, 195.0]) * BAR
    return FrictionCurve(
        test, np.array(speed), up + 2 * shift * BAR, down, displacement * CM3_PER_REV, 250.0 * load * 10, 10, load
    )


def error(test, percent, nominal=500.0):
    """Modelled less measured in % of nominal at 240, 250 and 1000 rpm."""
    speed = np.array([240.0, 250.001, 1000.0]) * RPM
    return TestError(test, speed, np.full(3, 100.0), 100.0 + 0.01 * nominal * np.array(percent), nominal)


# -- names, labels, units
def test_a_test_is_named_with_its_displacement_and_the_load_of_all_motors():
    assert (name("t_01.parquet"), name("bag")) == ("t_01", "bag")
    assert curve_label(curve()) == "t_01: 200 cm³/rev, 50000 N·m load"


def test_a_parameter_is_shown_in_the_unit_of_its_label():
    assert label("C4") == "C4 [rpm]"
    assert label("C2") == "C2 [N·m]"
    assert shown(MODEL, "C4") == pytest.approx(MODEL.value("C4") * 30.0 / np.pi)
    assert shown(MODEL, "C5") == MODEL.value("C5")
    assert shown(MODEL.only("motor"), "C5") == 0.0


def test_each_curve_is_drawn_over_its_own_numbers_in_its_panel():
    from winch_friction.report.practice_look import Curve

    html = curves_html(
        "T",
        "x [s]",
        ["a [N·m]", "b [bar]"],
        [Curve("one", [0, 1], [2, 3]), Curve("two", [4, 5], [6, 7], 1, "measured", "dots", 0)],
        "c",
    )
    lines = drawn(html)
    assert [(text, x.tolist(), y.tolist(), row, role) for text, x, y, row, role in lines] == [
        ("one", [0, 1], [2, 3], 0, "plain"),
        ("two", [4, 5], [6, 7], 1, "measured"),
    ]
    assert [each[6:] for each in content(html)["lines"]] == [["lines", "", -1], ["dots", "", 0]]


# -- verification
def test_errors_stand_by_test_model_and_side_of_250_rpm():
    errors = {
        "first loop": [error("a.csv", (9.0, -5.0, 2.0)), error("b.csv", (1.0, 2.0, -3.0), 400.0)],
        "joint fit": [error("a.csv", (4.0, 1.0, -2.5)), error("b.csv", (-7.0, 0.5, 0.1), 400.0)],
    }
    system = SimpleNamespace(
        tests=[SimpleNamespace(curve=curve("a.csv"))], held_out=[SimpleNamespace(curve=curve("b"))]
    )
    practice = SimpleNamespace(errors=errors, system=system)
    (table,) = tables(_friction_html(practice))
    assert table == [
        ["test", "use", "nominal [N·m]", "1st ≥250", "1st <250", "joint ≥250", "joint <250"],
        ["a", "fit", "500", "5", "9", "2.5", "4"],
        ["b", "kept", "400", "3", "1", "0.5", "7"],
    ]
    lines = drawn(percent_html(practice))
    assert [(text, row, role) for text, _, _, row, role in lines] == [
        ("fitted", 0, "after"),
        ("held out", 0, "before"),
        ("fitted", 1, "after"),
        ("held out", 1, "before"),
    ]
    assert lines[1][2] == pytest.approx([1.0, 2.0, -3.0], rel=1e-5)
    assert lines[0][1] == pytest.approx([240.0, 250.0, 1000.0], rel=1e-5)


def test_pressure_errors_turning_and_at_rest_hoisting_and_lowering_in_bar():
    speed = np.array([0.0, 0.0, 100.0, 100.0, -100.0, -100.0])
    off = np.array([8.0, -8.0, 3.0, 3.0, -1.0, -1.0])
    check = PressureCheck("r.csv", "main", np.arange(6.0), speed, np.full(6, 100 * BAR), (100.0 + off) * BAR)
    ((run, model, turning, every, hoisting, lowering),) = _check_rows({"joint fit": [check]})
    assert (run, model) == ("r", "joint fit")
    assert (hoisting, lowering) == pytest.approx((3.0, -1.0))
    assert turning == pytest.approx(np.sqrt(5.0))
    assert every == pytest.approx(np.sqrt((128.0 + 20.0) / 6.0))


def test_the_summary_says_fitted_and_held_out_tests_above_and_below_250_rpm_and_bar_while_turning():
    errors = [error("a", (9.0, -5.0, 2.0)), error("b", (4.0, 6.0, 1.0)), error("c", (1.0, 2.0, -3.0))]
    still = PressureCheck(
        "sea.csv", "active", np.arange(2.0), np.array([0.0, 100.0]), np.zeros(2), np.array([9e5, 4e5])
    )
    system = SimpleNamespace(tests=[0, 1], unseen=[])
    said = summary_lines(SimpleNamespace(system=system, errors={"joint fit": errors}, ahc={"joint fit": [still]}))
    assert said == [
        "Total friction on 2 fitted tests: within 6 % of nominal torque above 250 rpm, 9 % below.",
        "Total friction on 1 held-out tests: within 3 % of nominal torque above 250 rpm, 1 % below.",
        "sea.csv: predicted pressure within 4 bar RMS while turning.",
        "Not determined by these tests, held by the prior: nothing.",
    ]
    # of all tests fitted and none held out nothing is said, and every direction that nothing was seen of is named
    several = SimpleNamespace(tests=[0, 1, 2], unseen=["C1 with C3", "C4", "C5"])
    said = summary_lines(SimpleNamespace(system=several, errors={"joint fit": errors}, ahc={"joint fit": []}))
    assert said == [
        "Total friction on 3 fitted tests: within 6 % of nominal torque above 250 rpm, 9 % below.",
        "Not determined by these tests, held by the prior: C1 with C3; C4; C5.",
    ]


# -- loops
def loops(costs, held=()):
    models = (MODEL, MODEL.with_values({"C3": 77.0, "K4": 7.0}))
    own = [
        SimpleNamespace(number=k + 1, cost=cost, model=model)
        for k, (cost, model) in enumerate(zip(costs, models, strict=True))
    ]
    return SimpleNamespace(system=SimpleNamespace(loops=own, held_out_costs=list(held)))


@pytest.mark.parametrize(
    ("costs", "held", "said"),
    [
        ((8.0, 2.0), (), "2 loops lower E by 75 % on the fitted tests."),
        (
            (8.0, 2.0),
            (10.0, 6.0),
            "2 loops lower E by 75 % on the fitted tests and lower it by 40 % on the held-out ones (no over-fit).",
        ),
        (
            (8.0, 4.0),
            (10.0, 15.0),
            "2 loops lower E by 50 % on the fitted tests and raise it by 50 % on the held-out ones (over-fit).",
        ),
    ],
)
def test_the_loops_are_judged_by_what_they_do_to_held_out_tests(costs, held, said):
    assert _loop_verdict(loops(costs, held)) == said


def test_each_loop_has_its_column_of_parameters_and_costs(monkeypatch):
    from winch_friction.report import practice_loops

    for each in ("motor_change_html", "derived_html", "map_derived_html"):
        monkeypatch.setattr(practice_loops, each, lambda _: "")
    (table,) = tables(loop_html(loops((8.0, 2.0), (10.0, 6.0))))
    rows = {row[0]: row[1:] for row in table}
    assert rows["parameter"] == ["loop 1", "loop 2"]
    assert rows["C3 [N·m]"][1] == "77"
    assert rows["K4 [N·m]"] == [f"{MODEL.value('K4'):.4g}", "7"]
    assert rows["cost E"] == ["8", "2"]
    assert rows["cost E on held-out tests"] == ["10", "6"]


def test_friction_by_the_map_is_that_of_hoisting_and_lowering_in_the_mean_taken_off(monkeypatch):
    """The map says 1 % of the pressure, so 2.00 N m in the mean of 205 and 195 bar."""
    asked = []

    def loss(speed, pressure, displacement):
        asked.append(displacement)
        return pressure / BAR / 100.0

    own = curve()
    zero = MODEL.only("motor").with_values(dict.fromkeys(MODEL.only("motor").parameter_names, 0.0))
    system = SimpleNamespace(tests=[SimpleNamespace(curve=own)], held_out=[], loops=[SimpleNamespace(motor=zero)])
    lines = drawn(map_derived_html(SimpleNamespace(system=system, map=SimpleNamespace(torque_loss=loss))))
    total = 10 * own.friction_torque
    assert [text.partition(",")[2] for text, *_ in lines] == [" 50000 N·m load", " 50000 N·m load, map"]
    assert lines[0][2] == pytest.approx(total, rel=1e-5)
    assert lines[1][2] == pytest.approx(total - 10 * np.array([2.0, 2.01]), rel=1e-5)
    assert asked[0] == pytest.approx(200.0 * CM3_PER_REV)


def test_the_map_is_compared_at_the_lightest_and_the_heaviest_tests():
    every = [curve(f"{d}_{load}", d, load) for load in (900.0, 100.0, 500.0) for d in (200.0, 70.0, 140.0)]
    chosen = {each.test for each in _extremes(every)}
    assert {"70.0_100.0", "200.0_900.0"} <= chosen
    assert len(chosen) == 5
    assert not {each for each in chosen if each.endswith("_500.0")} - {"70.0_500.0"}


# -- the tests and the system
def test_the_tests_are_listed_with_all_motors_displacement_the_load_in_t_and_their_use(monkeypatch):
    monkeypatch.setattr(practice_system, "plateau_html", lambda _: "")
    run = _Run
    own = [
        SimpleNamespace(run=run(f"{c.test}.csv", load), curve=c, plateaus=[0] * 12)
        for c, load in ((curve("a"), 4e4), (curve("b", 70.0), 6e4))
    ]
    practice = SimpleNamespace(system=SimpleNamespace(tests=own[:1], held_out=own[1:]))
    (table,) = tables(practice_system._tests_html(practice))
    low, high = (f"{each / RPM:.4g}" for each in (10.0, 50.0))
    assert table[1:] == [
        ["a", "2000/200", "40", "12", low, high, "fitted"],
        ["b", "700/70", "60", "12", low, high, "held out"],
    ]


class _Run:
    def __init__(self, text, load):
        self.name, self.load = text, load

    def __getitem__(self, column):
        return {"hook_load": np.array([self.load, self.load])}[column]


def test_a_cycle_is_drawn_with_the_plateaus_at_their_times_and_means():
    time = np.arange(4.0)
    run = {
        "main.pressure_a": np.full(4, 210 * BAR),
        "main.pressure_b": np.full(4, 30 * BAR),
        "motor_speed": 100 * RPM * time,
    }
    record = type("R", (), {"name": "a.csv", "time": time, "__getitem__": lambda _, key: run[key]})()
    plateaus = [SimpleNamespace(start=1.0, end=2.0, speed=150 * RPM, pressure_drop=180 * BAR)]
    tests = [SimpleNamespace(run=record, plateaus=plateaus)]
    lines = drawn(practice_system.plateau_html(SimpleNamespace(system=SimpleNamespace(tests=tests))))
    assert [(text, row, role) for text, _, _, row, role in lines] == [
        ("logged", 0, "measured"),
        ("logged", 1, "measured"),
        ("plateau", 0, "after"),
        ("plateau", 1, "after"),
    ]
    assert lines[0][2] == pytest.approx([0.0, 100.0, 200.0, 300.0], rel=1e-5)
    assert lines[1][2] == pytest.approx(180.0)
    assert lines[2][1][:2].tolist() == [1.0, 2.0]
    assert lines[2][2][:2] == pytest.approx(150.0)
    assert lines[3][2][:2] == pytest.approx(180.0)


def test_the_fits_of_the_system_stand_side_by_side(monkeypatch):
    monkeypatch.setattr(practice_system, "breakdown_html", lambda _: "")
    fits = {
        "eq 8": SimpleNamespace(model=MODEL, cost=3.5, evaluations=120, condition=42.0),
        "eq 10": SimpleNamespace(model=MODEL.with_values({"C3": 77.0}), cost=3.25, evaluations=70, condition=1.0),
    }
    html = practice_system._system_html(SimpleNamespace(system=SimpleNamespace(fits=fits)))
    rows = {row[0]: row[1:] for row in tables(html)[0]}
    assert rows["parameter"] == ["eq 8", "eq 10"]
    assert rows["C3 [N·m]"] == [f"{MODEL.value('C3'):.4g}", "77"]
    assert (rows["cost E"], rows["model evaluations"]) == (["3.5", "3.25"], ["120", "70"])
    assert "condition number 42 " in html


def test_the_measured_friction_of_a_test_is_per_motor_over_rpm():
    ((_, speed, torque, *_),) = drawn(practice_system.friction_html([curve()]))
    assert speed == pytest.approx(np.array([10.0, 50.0]) / RPM)
    assert torque == pytest.approx(np.array([5.0, 6.0]) * BAR * 200.0 * CM3_PER_REV)


# -- the joint fit
def test_prior_fit_and_bootstrap_of_a_parameter_stand_in_their_columns(monkeypatch):
    monkeypatch.setattr(practice_joint, "joint_breakdown_html", lambda _: "")
    only = MODEL.only("gear and drum")
    k = only.parameter_names.index("C4")
    values, std = np.array(only.values), np.full(len(only.values), 1.0)
    values[k], std[k] = 120.0 * RPM, 5.0 * RPM
    fitted = SimpleNamespace(parameters=only.parameters, values=values, std=std)
    before = SimpleNamespace(value=lambda p: only.value(p) if p != "C4" else 100.0 * RPM, std=3.0 * std)
    joint = SimpleNamespace(
        model=fitted,
        prior=before,
        sensor_errors={"pressure_offset": (2 * BAR, 0.5 * BAR), "displacement_scale": (0.02, 0.01)},
    )
    boot = SimpleNamespace(names=only.parameter_names, std=7.0 * std)
    tie = SimpleNamespace(first="C2", second="C3", cosine=0.99991)
    system = SimpleNamespace(joint=joint, bootstrap=boot, ties=[tie], unseen=[])
    html = practice_joint.joint_html(SimpleNamespace(system=system))
    parameters, sensors = tables(html)
    assert parameters[0] == ["parameter", "unit", "before", "its σ", "joint fit", "σ", "σ, bootstrap"]
    assert parameters[1 + k] == ["C4", "rpm", "100", "15", "120", "5", "35"]
    assert sensors[1:] == [["pressure offset", "2", "0.5", "bar"], ["displacement scale", "0.02", "0.01", "–"]]
    assert "C2 and C3 (cosine 0.99991)" in html


def test_the_heaviest_test_is_taken_apart():
    tests = [SimpleNamespace(curve=curve(f"t{load:.0f}.csv", load=load, shift=load / 1e4)) for load in (4e3, 9e3, 5e3)]
    system = SimpleNamespace(tests=tests, joint=SimpleNamespace(model=MODEL))
    html = practice_joint.joint_breakdown_html(SimpleNamespace(system=system))
    assert "the heaviest fitted test, t9000: " in html
    measured = next(each for each in drawn(html) if each[0] == "measured")
    assert measured[2] == pytest.approx(tests[1].curve.friction_torque, rel=1e-5)
    assert measured[1] == pytest.approx(np.array([10.0, 50.0]) / RPM)


# -- the motor
def fit(rms=1.0, cost=4.0, evaluations=10, values=None, std=(0.1, 0.2), count=5):
    model = MODEL.only("motor")
    own = SimpleNamespace(
        parameters=model.parameters[:2],
        values=values or (2.0, -4.0),
        std=np.array(std),
        value=dict(zip((p.name for p in model.parameters[:2]), (8.0, 9.0), strict=True)).get,
    )
    return SimpleNamespace(
        rms=rms, cost=cost, evaluations=evaluations, parameter_count=count, model=own, at_bound=[], condition=12.0
    )


def motor(**more):
    scores = [
        SimpleNamespace(name="mj4", fitted=fit(), held_out=1.5, bic=-30.0),
        SimpleNamespace(name="mj6", fitted=fit(0.8, 3.0, 20, count=6), held_out=1.25, bic=-40.0),
    ]
    one = np.array([100.0, 200.0, 300.0, 400.0]) * RPM
    table = SupplierTable(
        "maker",
        one,
        np.full(4, 100 * BAR),
        np.full(4, 200 * CM3_PER_REV),
        np.full(4, 2.0),
        np.ones(4),
        215 * CM3_PER_REV,
    )
    base = {
        "scores": scores,
        "chosen": scores[0],
        "recommended": "mj6",
        "table": table,
        "weighting": "nominal",
        "by_complex": {"mj4": fit(cost=4.5, evaluations=300), "mj6": fit(cost=3.5, evaluations=900)},
    }
    return SimpleNamespace(**(base | more))


def test_the_motor_models_are_ranked_with_their_own_numbers_and_the_used_is_not_the_recommended():
    html = practice_motor.ranking_html(motor())
    ranked, fitters = tables(html)
    assert [row[0] for row in ranked[1:]] == ["MJ4", "MJ6"]
    assert ranked[1][3:] == ["5", "1", "1.5", "-30"]
    assert ranked[2][3:] == ["6", "0.8", "1.25", "-40"]
    assert fitters[1:] == [["MJ4", "4", "4.5", "10", "300", "30"], ["MJ6", "3", "3.5", "20", "900", "45"]]
    assert "Used: MJ4. Held-out displacements, with the parameters counted, recommend MJ6." in html
    assert "4 rows of maker, weighting &#x27;nominal&#x27;" in html


def test_a_parameters_error_is_in_per_cent_of_its_size_and_the_other_fitters_value_beside_it():
    (table,) = tables(practice_motor.parameter_table(fit(), fit()))
    assert table[0] == ["parameter", "unit", "least squares", "standard error", "%", "complex", "meaning"]
    assert [row[2:6] for row in table[1:]] == [["2", "0.1", "5", "8"], ["-4", "0.2", "5", "9"]]


def test_the_error_of_the_motor_is_model_minus_table_in_per_cent_of_nominal_by_speed():
    """Nominal: 200 cm³/rev at 100 bar; each row is in one range of speed."""
    nominal = 200 * CM3_PER_REV * 100 * BAR
    model = SimpleNamespace(torque=lambda points: np.array([2.0, 2.0, 2.0, 2.0 + 0.03 * nominal]))
    chosen = SimpleNamespace(fitted=SimpleNamespace(model=model))
    lines = drawn(practice_motor.error_html(motor(chosen=chosen)))
    assert [text for text, *_ in lines] == ["100 to 175 rpm", "175 to 250 rpm", "250 to 325 rpm", "325 to 400 rpm"]
    assert [len(y) for _, _, y, *_ in lines] == [1, 1, 1, 1]
    assert [float(y[0]) for _, _, y, *_ in lines] == pytest.approx([0.0, 0.0, 0.0, 3.0], abs=1e-5)
    assert lines[3][1] == pytest.approx(200.0)


def test_the_shares_of_the_motors_losses_are_of_all_of_them():
    only = MODEL.only("motor")
    html = practice_motor.contributions_html(only)
    (table,) = tables(html)
    assert sum(float(row[1]) for row in table[1:]) == pytest.approx(100.0, abs=0.5)
    speed = drawn(html)[0][1]
    assert (speed[0], speed[-1]) == pytest.approx((300.0, 2500.0))
    parts = {text: y for text, _, y, *_ in drawn(html)}
    assert parts["motor coulomb"] == pytest.approx(only.value("K4"), rel=0.05)
