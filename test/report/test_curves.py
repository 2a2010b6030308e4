"""Friction curves as pages: the difference of two models and the shadow of one are what their labels say."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from winch_friction.cli import console
from winch_friction.cli.main import run
from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.winch.model_curve import ModelCurve, model_curve
from winch_friction.records.model_file import load_model, save_model
from winch_friction.report import curves
from winch_friction.report.corrections import correction_rows
from winch_friction.report.curves import (
    SPEED,
    TORQUE,
    course_plot,
    curve_plot,
    difference_plot,
    joint_std,
    pair_plot,
    parameter_html,
    parts_plot,
)
from winch_friction.report.tables import number

FIRST, SECOND = load_model("a6vm215_crane1"), load_model("a6vm215_crane2")


@pytest.fixture(scope="module")
def pair(crane_150t):
    return [model_curve(each, crane_150t, load=55e3, speed=[20.0, 80.0, 150.0]) for each in (FIRST, SECOND)]


def test_deviations_of_independent_estimates_add_by_their_squares(pair):
    first, second = pair
    assert joint_std(first, second) == pytest.approx(np.hypot(first.std, second.std))


def test_the_difference_is_the_second_model_minus_the_first(pair):
    first, second = pair
    columns = pair_plot(first, second).frames[0].columns
    assert columns[SPEED] == pytest.approx(np.array([20.0, 80.0, 150.0]) * 30.0 / np.pi)
    assert columns["difference [N·m]"] == pytest.approx(second.torque - first.torque)
    width = columns["plus 1 σ [N·m]"] - columns["difference [N·m]"]
    assert width == pytest.approx(np.hypot(first.std, second.std))
    assert columns["difference [N·m]"] - columns["less 1 σ [N·m]"] == pytest.approx(width)
    parts = difference_plot(first, second).frames[0].columns
    assert parts["viscous [N·m]"] == pytest.approx(second.parts["viscous"] - first.parts["viscous"])


def test_the_shadow_of_a_curve_is_one_standard_deviation(pair):
    columns = curve_plot(pair[:1]).frames[0].columns
    assert columns[SPEED] == pytest.approx(np.array([20.0, 80.0, 150.0]) * 30.0 / np.pi)
    assert columns["plus 1 σ [N·m]"] - columns[TORQUE] == pytest.approx(pair[0].std)
    assert columns[TORQUE] - columns["less 1 σ [N·m]"] == pytest.approx(pair[0].std)


def curve(model="one", load=55e3, std=2.0, torque=(30.0, 10.0, 20.0), **parts):
    """Torque in N m at 10, 20 and 30 rpm."""
    speed = np.array([10.0, 20.0, 30.0]) * np.pi / 30.0
    return ModelCurve(model, load, 215 * CM3_PER_REV, speed, np.array(torque), np.full(3, std),
                      {name: np.array(part) for name, part in parts.items()}, 0.0 * speed)  # fmt: skip


def drawn(plot):
    """Labels of the lines with their panel, role, kind and what is drawn."""
    return {
        line.label: (line.row, line.role, line.kind, list(plot.frames[line.frame].columns[line.y]))
        for line in plot.lines
    }


def test_each_load_has_its_own_line_and_shadow_where_the_deviation_is_known():
    light, heavy = curve(load=15e3), curve(load=100e3, std=float("nan"), torque=(50.0, 60.0, 70.0))
    plot = curve_plot([light, heavy])
    assert drawn(plot) == {
        "15 t ± 1 σ": (0, "noise", "band", [28.0, 8.0, 18.0]),
        "15 t": (0, "plain", "lines", [30.0, 10.0, 20.0]),
        "100 t": (0, "plain", "lines", [50.0, 60.0, 70.0]),
    }
    assert [line.upper for line in plot.lines] == ["plus 1 σ [N·m]", "", ""]
    both = drawn(curve_plot([light, curve(load=100e3, torque=(50.0, 60.0, 70.0))]))
    assert both["100 t ± 1 σ"][-1] == [48.0, 58.0, 68.0]
    assert "at 215 cm³/rev" in plot.caption


def test_the_first_model_is_before_and_the_second_after():
    plot = pair_plot(curve("one"), curve("two", torque=(31.0, 12.0, 17.0)))
    lines = drawn(plot)
    assert lines["one"] == (0, "before", "lines", [30.0, 10.0, 20.0])
    assert lines["two"] == (0, "after", "lines", [31.0, 12.0, 17.0])
    assert lines["difference"] == (1, "measured", "lines", [1.0, 2.0, -3.0])
    assert lines["± 1 σ"][:3] == (1, "noise", "band")
    assert "two minus one" in plot.caption
    same = pair_plot(curve("one"), curve("one", torque=(31.0, 12.0, 17.0)))
    assert [list(same.frames[0].columns[line.y]) for line in same.lines[:2]] == [[30.0, 10.0, 20.0], [31.0, 12.0, 17.0]]


def test_terms_that_differ_are_drawn_also_where_one_model_lacks_them():
    first, second = (
        curve("one", a=(1.0, 1.0, 1.0), b=(2.0, 2.0, 2.0)),
        curve("two", a=(1.0, 1.0, 1.0), c=(0.0, 0.0, -4.0)),
    )
    plot = difference_plot(first, second)
    assert {name: values for name, (*_, values) in drawn(plot).items()} == {"b": [-2.0] * 3, "c": [0.0, 0.0, -4.0]}
    assert plot.frames[0].columns[SPEED] == pytest.approx([10.0, 20.0, 30.0])
    assert plot.caption == "Terms of two minus those of one, at 55 t."


def test_terms_are_stacked_below_what_they_are_together():
    lines = drawn(parts_plot(curve(coulomb=(20.0, 4.0, 8.0), line_loss=(10.0, 6.0, 12.0))))
    assert lines == {
        "coulomb": (0, "plain", "area", [20.0, 4.0, 8.0]),
        "line loss": (0, "plain", "area", [10.0, 6.0, 12.0]),
        "together": (0, "measured", "lines", [30.0, 10.0, 20.0]),
    }


def test_a_models_page_says_the_first_the_least_and_the_last_of_its_middle_load(tmp_path, monkeypatch):
    monkeypatch.setattr(curves, "plot_html", lambda plot: "")
    of = [curve(load=load, torque=torque) for load, torque in
          ((15e3, (1.0, 2.0, 3.0)), (55e3, (30.0, 10.0, 20.0)), (100e3, (7.0, 8.0, 9.0)))]  # fmt: skip
    page = curves.write_model_page(tmp_path / "m.html", SECOND, of, "crane_150t").read_text()
    assert re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", page) == [
        ("10 rpm, 55 t", "30 N·m"), ("20 rpm, 55 t", "10 N·m"), ("30 rpm, 55 t", "20 N·m"),
    ]  # fmt: skip
    assert f"{SECOND.name}: {len(SECOND.terms)} terms, 10 parameters, on crane crane_150t" in page


def test_a_parameters_deviation_is_its_own_and_none_where_the_model_knows_none():
    cell = lambda html, name: re.findall(r"<td[^>]*>(.*?)</td>", re.search(rf"<tr><td>{name}</td>.*?</tr>", html)[0])
    k = SECOND.parameter_names.index("C4")
    known, unknown = parameter_html(SECOND), parameter_html(replace(SECOND, covariance=None))
    rpm = 30.0 / np.pi
    assert cell(known, "C4")[1:4] == [number(SECOND.values[k] * rpm), number(SECOND.std[k] * rpm), "rpm"]
    assert cell(unknown, "C4")[1:4] == [number(SECOND.values[k] * rpm), "–", "rpm"]


# -- what a model says is wrong with logs and crane file
HELD = (
    (Correction("pressure_offset", 2.5e5, 1e4, groups=("active", "passive")),
     (2.5, 0.1, "bar", "active, passive groups")),
    (Correction("layer_radius", 0.03, layers=(2,)), (0.03, None, "m", "layer 2")),
    (Correction("tare_load", 1500.0, 2000.0), (1.5, 2.0, "t", "always")),
    (Correction("inertia", -7e-20, 0.5), (0.0, 0.5, "kg·m²", "always")),  # the rounding of a solver
    (Correction("pressure_bend", 0.02, 0.001, beyond=2e7, groups=("main",)),
     (0.02, 0.001, "–", "main group; beyond 200 bar")),
    (Correction("accumulator_warmth", 0.02, 0.001, time_constant=45.0, during=((1.7e9, np.inf),)),
     (0.02, 0.001, "–", "over 45 s; since 2023-11-14 22:13 UTC")),
    (Correction("pressure_creep", 3e5, 1e4, during=((0.0, 60.0),)), (3.0, 0.1, "bar", "0 s to 60 s")),
    (Correction("signal_course", 0.15, 0.01, course=((0.0, 0.5), (40.0, 1.0), (90.0, 0.0))),
     (0.15, 0.01, "s", "by a course of 3 points over 90 s")),
)  # fmt: skip


@pytest.mark.parametrize(("correction", "said"), HELD)
def test_a_correction_stands_with_what_it_is_restricted_to_in_the_units_that_people_read(correction, said):
    ((name, value, std, *more, meaning),) = correction_rows([correction])
    assert (name, meaning) == (correction.name, correction.declared.doc)
    assert value == pytest.approx(said[0])
    assert (std, tuple(more)) == (said[1] if said[1] is None else pytest.approx(said[1]), said[2:])


def test_a_models_page_and_words_say_what_it_corrects_and_draw_a_delays_course(tmp_path, capsys, monkeypatch):
    """A repaired model that only corrects a log looked like the one that it was made from."""
    model = replace(SECOND, corrections=tuple(each for each, _ in HELD))
    path = str(save_model(model, tmp_path / "m.yaml"))
    monkeypatch.setattr(console.stdout, "width", 200)  # else names are folded
    assert run(["show", path, "--out", str(tmp_path / "m.html")]) == 0
    told, page = capsys.readouterr().out, (tmp_path / "m.html").read_text()
    assert "corrections: what its logs or its crane file have wrong" in told
    for each, (*_, where) in HELD:
        assert each.name in told
        assert where.split()[0] in told
        assert each.name in page.replace("<wbr>", "")
    assert page.count("How late the speed is logged.") == 1
    assert "What logs or crane file have wrong" in page
    assert run(["show", path, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["corrections"].keys() == {each.name for each, _ in HELD}
    assert run(["show", "a6vm215_crane2", "--out", str(tmp_path / "none.html")]) == 0
    assert "corrections" not in capsys.readouterr().out
    assert "have wrong" not in (tmp_path / "none.html").read_text()


@pytest.mark.parametrize(
    ("name", "said"), [("signal_course", "the speed is"), ("pressure_course", "the pressures are")]
)
def test_a_course_is_drawn_in_milliseconds_over_the_time_since_a_run_began(name, said):
    plot = course_plot(Correction(name, 0.2, course=((0.0, 0.5), (40.0, 1.0), (90.0, 0.0))))
    (columns,) = (each.columns for each in plot.frames)
    assert [list(each) for each in columns.values()] == [[0.0, 40.0, 90.0], pytest.approx([100.0, 200.0, 0.0])]
    assert said in plot.caption
