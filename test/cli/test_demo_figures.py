"""Each figure of the demo is taken from where it says: legs, bins, tables, picture, plan and results, by hand."""

import json
import re
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from winch_friction.cli import demo
from winch_friction.cli.demo import picture, processes, tuning
from winch_friction.cli.demo.learned import LearnedParameter, learned_parameters
from winch_friction.cli.demo.legs import voyage_legs
from winch_friction.cli.demo.measures import BINS, PhaseFigures, bin_label, measure, of_feedforward, of_leg
from winch_friction.cli.demo.page import (
    agreement_table,
    error_table,
    learned_table,
    residual_table,
    search_table,
    sections,
)
from winch_friction.cli.demo.plan import make_plan
from winch_friction.cli.demo.plots import ERROR, TIME, TORQUE, leg_plots
from winch_friction.cli.demo.recording import COMPENSATOR, ESTIMATOR, TRUTH, Recording, _row
from winch_friction.cli.demo.tuning import EfficiencySearch, search_efficiency
from winch_friction.physics.channels import RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.scaled import scaled_system
from winch_friction.records.model_file import load_model
from winch_friction.replay.live import Comparison

SEARCH = EfficiencySearch((0.78, 0.82, 0.86), (0.031, 0.0123, 0.025))
AGREEMENTS = [Comparison("compensator", 900, 2, 3e-12, 1.0), Comparison("estimator", 800, 0, 5e-3, 2.0)]
# one more than the truth by 2 sigma, one less by 3
PARAMETERS = [
    LearnedParameter("C6", "rad/s", 1.0, 3.0, 0.5, 2.0),
    LearnedParameter("K4", "N*m", 10.0, 5.0, 1.0, 8.0),
]


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    out = tmp_path_factory.mktemp("out") / "sea"
    return make_plan(out, "ahc_irregular", voyage_legs("ahc_irregular"), 0.82, 60.0, 7, 1.3)


@pytest.fixture(scope="module")
def figures(plan):
    """Left of the heave in mm: 40, 41, 42 without, 30, 31, 32 by efficiency, then 20, 21, 22 and 10, 11, 12."""
    found = []
    for k, phase in enumerate(plan.phases):
        way, leg = divmod(k, 3)
        left = 1e-3 * (40 - 10 * way + leg)
        errors = tuple(100.0 * way + 10.0 * leg + each for each in range(3))
        shares = tuple(0.1 * way + 0.01 * (leg + 4 * each) for each in range(3))
        nan = float("nan")
        found.append(PhaseFigures(phase, left, 2.0 * left, (*errors, nan), (*shares, nan), 0.25 * way + 0.01 * leg))
    return found


def table(html):
    """The cells of each row, the head first."""
    rows = re.findall(r"<tr>(.*?)</tr>", html)
    cells = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]
    return [[unescape(re.sub(r"<[^>]*>", "", cell)).replace("\xa0", " ") for cell in row] for row in cells]


# -- what is measured
def measured(plan, truth, fed):
    """The figures of the third feedforward (of 0.9 of its model) on the first leg."""
    one = SimpleNamespace(phases=[plan.phases[6]])
    return measure(one, Recording(truth, fed, fed, []))[0]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_errors_are_by_the_speeds_of_their_bin_either_way_and_after_the_settling(sign, plan):
    """At the lower edges of three bins and far in the last: friction 100 to 400 N m, the model 1 to 4 more."""
    time = 500.0 + 0.1 * np.arange(600)
    at = np.minimum((time - 500.0) // 10.0 - 2.0, 3.0).astype(int)  # -2, -1 while it settles
    rpm = np.array([0.0, 50.0, 250.0, 3900.0, 0.0, 0.0])[at]
    speed = sign * rpm * RPM
    friction = 100.0 * (at + 1.0)
    wrong = np.where(at < 0, 77.0, at + 1.0)
    error = np.where(at < 0, 1.0, 0.002)
    truth = np.column_stack([time, error, speed, friction, 9.0 * friction])
    found = measured(plan, truth, np.column_stack([time, 0.9 * (friction + sign * wrong), 5.0 * speed]))
    assert found.friction_error == pytest.approx((1.0, 2.0, 3.0, 4.0))
    assert found.friction_error_share == pytest.approx((0.01, 0.01, 0.01, 0.01))
    assert found.residual == pytest.approx(0.002)
    assert np.isnan(found.residual_at_reversal)  # there was none
    assert found.gain == 0.0


def test_what_is_left_around_reversals_is_of_their_window_alone(plan):
    time = 0.25 * np.arange(241)
    near = (time >= 40.0) & (time <= 41.0)
    truth = np.column_stack([time, 0.006 * near, np.where(time < 40.0, 9.0, -9.0), time + 1.0, time])
    found = measured(plan, truth, truth[:, [0, 3, 2]])
    assert found.residual_at_reversal == pytest.approx(0.006)
    assert found.residual == pytest.approx(0.006 * np.sqrt(5.0 / 161.0))


def test_what_was_fed_is_read_at_the_times_of_the_truth(plan):
    time = np.arange(0.0, 60.0, 0.1)
    truth = np.column_stack([time, 0.0 * time + 1.0, 20.0 + 0.0 * time, 50.0 + time, 0.0 * time])
    coarse = np.arange(0.0, 61.0, 1.0)
    found = measured(plan, truth, np.column_stack([coarse, 0.9 * (50.0 + coarse), 0.0 * coarse]))
    assert found.friction_error[1] == pytest.approx(0.0, abs=1e-9)


def test_bins_are_named_by_their_edges():
    assert [bin_label(each) for each in BINS] == ["0-50 rpm", "50-250 rpm", "250-1000 rpm", ">1000 rpm"]


def test_the_figures_of_a_phase_are_told_by_their_names(plan, figures):
    row = figures[4]  # efficiency on the second leg
    assert row.title == "efficiency 0.82"
    content = row.as_dict()
    errors, shares = (content.pop(f"friction_torque_error_{each}") for each in ("rms_Nm", "share"))
    assert content == {
        "name": "efficiency, leg_2", "title": "efficiency 0.82, 15 t, 160 cm³/rev", "feedforward": "efficiency",
        "load_t": 15.0, "displacement_cm3_per_rev": 160.0, "residual_heave_rms_m": 0.031,
        "residual_heave_rms_at_reversal_m": 0.062, "less_than_without": 0.26,
    }  # fmt: skip
    assert list(errors.items())[:3] == [("0-50 rpm", 110.0), ("50-250 rpm", 111.0), ("250-1000 rpm", 112.0)]
    assert shares["250-1000 rpm"] == pytest.approx(0.19)
    assert [each.phase.feedforward.name for each in of_leg(figures, "leg_2")] == [
        "none", "efficiency", "seed", "learned",
    ]  # fmt: skip
    assert [each.phase.leg.name for each in of_feedforward(figures, "seed")] == ["leg_1", "leg_2", "leg_3"]


# -- the recording
def rows(times, add):
    return np.column_stack([times, times + add])


def test_a_recording_is_cut_at_its_pauses_in_all_that_it_has():
    """The node answers up to half a second before and after the truth's first and last row."""
    truth = np.concatenate([np.arange(0.0, 3.0), 10.0 + np.arange(0.0, 2.0), 20.0 + np.arange(0.0, 4.0)])
    fed, learned = truth + 0.4, truth - 0.4
    models = [object()]
    parts = Recording(rows(truth, 1.0), rows(fed, 2.0), rows(learned, 3.0), models).phases(3)
    for part, (first, count) in zip(parts, [(0.0, 3), (10.0, 2), (20.0, 4)], strict=True):
        own = first + np.arange(count)
        np.testing.assert_allclose(part.truth, rows(own, 1.0))
        np.testing.assert_allclose(part.fed, rows(own + 0.4, 2.0))
        np.testing.assert_allclose(part.learned, rows(own - 0.4, 3.0))
        assert part.models is models


def test_a_row_of_the_bag_has_what_the_recording_says():
    stamp = SimpleNamespace(sec=5, nanosec=500_000_000)
    message = SimpleNamespace(
        header=SimpleNamespace(stamp=stamp), position=[1.0, 2.0], velocity=[3.0, 3.5], effort=[4.0, 5.0]
    )
    assert _row(TRUTH, message) == (5.5, 2.0, 3.0, 4.0, 5.0)
    assert _row(COMPENSATOR, message) == _row(ESTIMATOR, message) == (5.5, 4.0, 3.0)


# -- the plan
def test_other_legs_have_a_light_and_a_heavy_load_on_smaller_motors():
    legs = voyage_legs("ahc_irregular")
    assert [leg.key for leg in legs] == [(55.0, 215.0), (15.0, 160.0), (100.0, 160.0)]
    assert [leg.title for leg in legs] == ["55 t, 215 cm³/rev", "15 t, 160 cm³/rev", "100 t, 160 cm³/rev"]
    assert [leg.name for leg in legs] == [leg.scenario.name for leg in legs] == ["leg_1", "leg_2", "leg_3"]


def test_each_process_is_told_its_own(plan):
    nodes, stage = plan.write()
    told = {name: each["ros__parameters"] for name, each in yaml.safe_load(nodes.read_text()).items()}
    assert told["/**"] == {
        "crane": "crane_150t", "model_file": "a6vm215_crane2", "groups": ["active", "passive"], "watchdog_timeout": 5.0,
    }  # fmt: skip
    assert told["/**/compensator"] == {"autostart": False}
    assert told["/**/estimator"] == {"checkpoint": str(plan.out / "estimator.json")}
    folder = plan.out / "legs"
    assert told["/**/simulator"] == {
        "autostart": False, "scenario": str(folder / "leg_1.yaml"), "duration": 60.0, "seed": 7, "friction_factor": 1.3,
        "rate": 0.0, "lockstep": True, "lockstep_timeout": 30.0, "subscribers": 3,
        "wait_for": ["compensator/friction_torque", "estimator/friction_torque"],
        "legs": [str(folder / "leg_2.yaml"), str(folder / "leg_3.yaml")],
    }  # fmt: skip
    content = json.loads(stage.read_text())
    phases = content.pop("phases")
    assert content == {"bag": str(plan.out / "bag"), "crane": "crane_150t", "groups": ["active", "passive"]}
    own = str(plan.out / "efficiency.yaml")
    assert [(p["name"], p["enabled"], *p["parameters"].values()) for p in phases[1::3]] == [
        ("none, leg_2", False, "a6vm215_crane2", 0.9, False),
        ("efficiency, leg_2", True, own, 1.0, False),
        ("seed, leg_2", True, "a6vm215_crane2", 0.9, False),
        ("learned, leg_2", True, "a6vm215_crane2", 0.9, True),
    ]
    assert list(phases[0]["parameters"]) == ["model_file", "scale", "follow_model_topic"]
    assert load_model(own).name == "efficiency_0.82"


def test_feedforwards_are_named_by_what_they_feed(plan):
    assert [each.title for each in plan.feedforwards] == ["none", "efficiency 0.82", "seed × 0.9", "learned × 0.9"]


# -- what was learned
def test_what_was_learned_stands_between_what_was_told_and_what_is_true(crane2_model):
    learned, truth = scaled_system(crane2_model, 1.2), scaled_system(crane2_model, 1.3)
    row = next(each for each in learned_parameters(crane2_model, learned, truth) if each.name == "C6")
    seed, unit = crane2_model.value("C6"), crane2_model.parameters[crane2_model.parameter_names.index("C6")].unit
    std = float(learned.std[learned.parameter_names.index("C6")])
    assert (row.seed, row.learned, row.truth) == pytest.approx((seed, 1.2 * seed, 1.3 * seed))
    assert (row.std, row.unit) == (std, unit)
    assert row.sigmas == pytest.approx(-0.1 * seed / std)


@pytest.mark.parametrize(("learned", "sigmas"), [(2.0, 0.0), (2.5, float("inf"))])
def test_of_what_is_stated_exactly_any_error_is_infinitely_far(learned, sigmas):
    assert LearnedParameter("x", "1", 1.0, learned, 0.0, 2.0).sigmas == sigmas


# -- the page
def test_a_row_of_what_is_left_is_a_leg_with_every_feedforward(plan, figures):
    assert table(residual_table(plan, figures)) == [
        ["leg", "none", "efficiency 0.82", "seed × 0.9", "learned × 0.9"],
        ["55 t, 215 cm³/rev", "40.0", "30.0 (−25 %)", "20.0 (−50 %)", "10.0 (−75 %)"],
        ["15 t, 160 cm³/rev", "41.0", "31.0 (−26 %)", "21.0 (−51 %)", "11.0 (−76 %)"],
        ["100 t, 160 cm³/rev", "42.0", "32.0 (−27 %)", "22.0 (−52 %)", "12.0 (−77 %)"],
    ]


def test_a_row_of_errors_is_a_feedforward_on_a_leg_by_bin(plan, figures):
    head, *body = table(error_table(plan, figures))
    assert head == ["feedforward", "leg", "0-50 rpm", "50-250 rpm", "250-1000 rpm", ">1000 rpm"]
    assert len(body) == 12
    assert body[4] == ["efficiency 0.82", "15 t, 160 cm³/rev", "110 (11 %)", "111 (15 %)", "112 (19 %)", "–"]
    assert [row[0] for row in body[::3]] == [each.title for each in plan.feedforwards]


def test_every_factor_that_was_tried_is_told_in_mm_and_the_best_one_is_marked(plan):
    html = search_table(plan, SEARCH)
    assert table(html)[1:] == [["0.78", "31", ""], ["0.82", "12.3", "best"], ["0.86", "25", ""]]
    assert "first leg (55 t, 215 cm³/rev)" in unescape(html)
    assert SEARCH.best == 0.82


def test_parameters_are_told_in_the_units_of_people(plan):
    head, speed, torque = table(learned_table(PARAMETERS))
    assert head[2:] == ["seed", "learned", "stated σ", "truth", "(learned − truth)/σ"]
    assert speed == ["C6", "rpm", "9.549", "28.65", "4.775", "19.1", "+2.0"]
    assert torque == ["K4", "N·m", "10", "5", "1", "8", "−3.0"]
    assert "1 of 2 lie within two of their stated" in learned_table(PARAMETERS)


def test_a_replay_that_differs_is_told_by_its_node():
    assert table(agreement_table(AGREEMENTS)) == [
        ["node", "samples", "without an answer", "largest relative difference", "within 1e-09"],
        ["compensator", "900", "2", "3.0e-12", "yes"],
        ["estimator", "800", "0", "5.0e-03", "NO"],
    ]


def test_the_page_decides_by_the_learned_feedforward(plan, figures):
    part = np.column_stack([np.arange(0.0, 30.0), *np.ones((4, 30))])
    empty = SimpleNamespace(phases=lambda count: [Recording(part, part, part, [])] * count)
    page = sections(plan, empty, figures, AGREEMENTS, PARAMETERS, SEARCH)
    html = {each.title: unescape(each.html()) for each in page}
    decision = html["Decision"]
    assert "(learned × 0.9) leaves 10.0 to 12.0 mm RMS of the heave: 75 to 77 % less" in decision
    facts = dict(re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", decision))
    assert facts == {
        "Left of the heave by leg, none": "40.0, 41.0, 42.0 mm",
        "Left of the heave by leg, efficiency 0.82": "30.0, 31.0, 32.0 mm",
        "Left of the heave by leg, seed × 0.9": "20.0, 21.0, 22.0 mm",
        "Left of the heave by leg, learned × 0.9": "10.0, 11.0, 12.0 mm",
        "Live equals replay": "NO",
    }
    same = sections(plan, empty, figures, AGREEMENTS[:1], PARAMETERS, SEARCH)[0].html()
    assert "<dt>Live equals replay</dt><dd>yes</dd>" in same
    told = html["What was done"]
    for each in (
        "(ahc_irregular, sea 7)", "turn 1.3 times as hard", "3 legs of 60 s each", "was sailed 4 times",
        "(55 t at 215 cm³/rev; 15 t at 160 cm³/rev; 100 t at 160 cm³/rev)", "at its best: 0.82 leaves",
        "the first 20 s of each leg left out",
    ):  # fmt: skip
        assert each in told
    assert "In sea/: bag, nodes.yaml, plan.json, demo.json, demo.png, learned_model.yaml, logs" in html["Files"]


# -- the picture
def sailed(plan):
    """Every phase 60 s long; the error is that of its number in mm, friction ten times it, what is fed a hundred."""
    time = np.arange(0.0, 60.5, 0.5)
    found = []
    for k in range(len(plan.phases)):
        stamp, one = 1000.0 * k + time, np.ones(len(time))
        truth = np.column_stack([stamp, 1e-3 * k * one, 7.0 * one, 10.0 * k * one, 8.0 * one])
        fed = np.column_stack([stamp + 0.2, 100.0 * k * one, 9.0 * one])
        found.append(Recording(truth, fed, fed, []))
    return SimpleNamespace(phases=lambda count: found[:count])


def test_a_picture_shows_the_last_seconds_of_a_leg():
    time = 100.0 + np.arange(0.0, 61.0)
    part = Recording(np.column_stack([time, time]), np.zeros((0, 2)), np.zeros((0, 2)), [])
    later = np.column_stack([np.append(time, 163.0), np.append(time, 163.0)])  # after the leg: on its way to zero
    since, kept = picture.shown(part, later)
    np.testing.assert_allclose(since, np.arange(40.0, 61.0))
    np.testing.assert_allclose(kept[:, 1], 100.0 + np.arange(40.0, 61.0))


def test_a_figure_of_the_page_has_each_feedforward_on_its_leg(plan):
    plots = leg_plots(plan, sailed(plan))
    assert [each.title for each in plots] == [leg.title for leg in plan.legs]
    plot = plots[1]  # phases 1, 4, 7 and 10
    assert plot.rows == [ERROR, TORQUE]
    drawn = {}
    for line in plot.lines:
        frame = plot.frames[line.frame].columns
        values = np.unique(np.round(frame[line.y], 9)).tolist()
        drawn[line.label, line.row, line.y] = values
        assert 40.0 <= frame[line.x].min() <= frame[line.x].max() <= 60.0
        assert line.x == TIME
    titles = [each.title for each in plan.feedforwards]
    assert drawn == {
        ("true friction", 1, TORQUE): [100.0],
        **{(title, 0, ERROR): [k] for title, k in zip(titles, (1.0, 4.0, 7.0, 10.0), strict=True)},
        **{(title, 1, TORQUE): [k] for title, k in zip(titles[1:], (400.0, 700.0, 1000.0), strict=True)},
    }
    assert [line.like for line in plot.lines if line.row == 1] == [-1, 1, 2, 3]  # as its error


class Axes(SimpleNamespace):
    """Keeps what is drawn."""

    def __init__(self):
        super().__init__(plotted={}, colours={}, texts=[], heights=[], ticks=[])

    def plot(self, x, y, label, color, **_):
        self.plotted[label], self.colours[label] = np.unique(np.round(y, 9)).tolist(), color

    def bar(self, places, heights, width, color):
        self.heights, self.colours = heights, color

    def bar_label(self, bars, texts, **_):
        self.texts = texts

    def set_xticks(self, places, names, **_):
        self.ticks = names

    def __getattr__(self, name):
        return lambda *_, **__: None


def test_a_picture_has_each_feedforward_in_its_colour_and_the_bars_of_its_leg(plan, figures):
    titles = [each.title for each in plan.feedforwards]
    here = sailed(plan).phases(12)[1::3]
    error, torque, left = Axes(), Axes(), Axes()
    picture._draw_residual(error, titles, here)
    picture._draw_torque(torque, titles, here)
    picture._draw_left(left, of_leg(figures, "leg_2"), " (tuned here)")
    assert error.plotted == dict(zip(titles, ([1.0], [4.0], [7.0], [10.0]), strict=True))
    assert torque.plotted == {"true friction": [100.0], titles[1]: [400.0], titles[2]: [700.0], titles[3]: [1000.0]}
    assert {title: error.colours[title] for title in titles[1:]} == {t: torque.colours[t] for t in titles[1:]}
    assert left.heights == pytest.approx([41.0, 31.0, 21.0, 11.0])
    assert list(left.texts) == ["41.0\n−1%", "31.0\n−26%", "21.0\n−51%", "11.0\n−76%"]
    assert list(left.ticks) == ["none", "efficiency\n(tuned here)", "seed", "learned"]
    assert list(left.colours) == list(error.colours.values())


# -- results
def test_results_are_those_of_the_voyage(plan, figures):
    found = demo._results(plan, figures, AGREEMENTS, 90.0)
    assert [each["name"] for each in found.pop("phases")] == [phase.name for phase in plan.phases]
    assert found == {
        "schema": "winch_friction.demo/2", "scenario": "ahc_irregular", "sea": 7, "friction_factor": 1.3,
        "live_equals_replay": [
            {"node": "compensator", "compared": 900, "missing": 2, "largest": 3e-12, "equal": True},
            {"node": "estimator", "compared": 800, "missing": 0, "largest": 5e-3, "equal": False},
        ],
        "simulated_seconds": 720.0, "elapsed_seconds": 90.0, "out": str(plan.out),
    }  # fmt: skip


def test_what_is_told_at_the_end_is_what_was_found(plan, figures, monkeypatch, capsys):
    shown = {}
    monkeypatch.setattr(demo, "show_table", lambda title, columns, rows: shown.update({title: (columns, rows)}))
    results = demo._results(plan, figures, AGREEMENTS, 90.0)
    results["parameters"] = [each.as_dict() for each in PARAMETERS]
    demo._show(plan, results)
    (title, (columns, legs)), (_, (_, parameters)) = shown.items()
    assert title.endswith("ahc_irregular, sea 7")
    assert columns == ("leg", "none", "efficiency 0.82", "seed × 0.9", "learned × 0.9")
    assert legs[2] == ["100 t, 160 cm³/rev", "42.0", "32.0 (-27%)", "22.0 (-52%)", "12.0 (-77%)"]
    assert parameters == [
        ["C6", "rad/s", "1", "3", "0.5", "2", "+2.0 σ"],
        ["K4", "N*m", "10", "5", "1", "8", "-3.0 σ"],
    ]
    said = capsys.readouterr().out
    assert "largest relative difference 5.0e-03; sailed at 8.0 x real time" in said


def test_an_earlier_demo_is_cleared_and_nothing_else(tmp_path):
    left = ("estimator.json", "demo.json", "demo.png", "demo.html", "learned_model.yaml")
    for name in ("plan.json", "notes.txt", *left):
        (tmp_path / name).write_text("x")
    (tmp_path / "bag").mkdir()
    (tmp_path / "legs").mkdir()
    demo._clear(tmp_path)
    assert {each.name for each in tmp_path.iterdir()} == {"plan.json", "notes.txt"}
    with pytest.raises(InputError, match="is a file; give a folder"):
        demo._clear(tmp_path / "plan.json")


def test_a_bar_is_full_when_the_next_phase_begins():
    bars = SimpleNamespace(done={}, started=[], console=SimpleNamespace(print=lambda text: said.append(text)))
    bars.update = lambda task, completed: bars.done.__setitem__(task, completed)
    bars.start_task = bars.started.append
    tasks, said = {"a": 1, "b": 2, "c": 3}, []
    demo._follow(bars, tasks, {"event": "phase", "name": "b"})
    assert (bars.done, bars.started) == ({1: 1.0}, [2])
    demo._follow(bars, tasks, {"event": "progress", "name": "b", "value": 0.4})
    assert bars.done == {1: 1.0, 2: 0.4}
    demo._follow(bars, tasks, {"event": "recorded", "messages": {"/x": 3, "/y": 4}})
    assert bars.done == {1: 1.0, 2: 1.0, 3: 1.0}
    assert said == ["recorded 7 messages"]


# -- processes
def staged(*lines, status=0):
    return SimpleNamespace(stdout=[json.dumps(each) for each in lines], wait=lambda: status, returncode=status)


def running(*dead):
    return {name: SimpleNamespace(poll=lambda name=name: 1 if name in dead else None) for name in processes.NODES}


def test_what_the_stage_says_is_handed_on_until_it_or_a_node_gives_up(tmp_path):
    one, two = {"event": "phase", "name": "a"}, {"event": "progress", "name": "a", "value": 0.5}
    assert list(processes.events(staged(one, two), running(), tmp_path)) == [one, two]
    with pytest.raises(InputError, match=r"^no answer node 'estimator' has ended, see .*/estimator\.log$"):
        list(processes.events(staged({"event": "error", "message": "no answer"}), running("estimator"), tmp_path))
    heard = processes.events(staged(one, two), running("simulator"), tmp_path)
    assert next(heard) == one
    with pytest.raises(InputError, match=r"^the demo stopped: node 'simulator' has ended"):
        next(heard)
    with pytest.raises(InputError, match=r"the stage ended with status 3, see .*/stage\.log$"):
        list(processes.events(staged(one, status=3), running(), tmp_path))


# -- the search
def test_the_search_is_coarse_and_then_fine_around_its_best(monkeypatch):
    tried = []

    def left(crane, truth, scenario, sea, efficiency):
        tried.append(efficiency)
        return abs(efficiency - 0.733)

    monkeypatch.setattr(tuning, "_residual", left)
    found = search_efficiency(None, None, None, 1)
    coarse = [round(0.5 + 0.04 * k, 2) for k in range(13)]
    assert tried == [*coarse, 0.71, 0.72, 0.73, 0.75, 0.76, 0.77]
    assert list(found.efficiencies) == sorted(tried)
    assert found.residuals == pytest.approx([abs(each - 0.733) for each in sorted(tried)])
    assert found.best == 0.73
    monkeypatch.setattr(tuning, "_residual", lambda *_: float("nan"))
    with pytest.raises(InputError, match="scenario 'short': too short to measure any heave after 20 s"):
        search_efficiency(None, None, SimpleNamespace(name="short"), 1)


@pytest.mark.parametrize(("best", "around"), [(0.5, [0.51, 0.52, 0.53]), (0.98, [0.95, 0.96, 0.97])])
def test_no_factor_beyond_the_ends_is_tried(best, around, monkeypatch):
    tried = []
    monkeypatch.setattr(tuning, "_residual", lambda *args: tried.append(args[-1]) or abs(args[-1] - best))
    assert search_efficiency(None, None, None, 1).best == best
    assert tried[13:] == around


def test_the_search_sails_its_sea_with_the_last_answer_to_a_fresh_sample(monkeypatch):
    class Sea:
        def __init__(self, scenario, crane, truth, seed):
            assert (scenario, crane, truth, seed) == ("leg", "crane", "truth", 7)
            self.fed, self.finished, self.fresh, self.sample = [], False, True, 10.0

        def step(self, torque):
            self.fed.append(torque)
            self.fresh, self.sample = len(self.fed) in (2, 3), 10.0 * (len(self.fed) + 1)
            self.finished = len(self.fed) == 5

        def result(self):
            assert self.fed == [10.5, 10.5, 30.5, 40.5, 40.5]
            time = 100.0 + np.array([0.0, 19.9, 20.0, 30.0])
            error = np.array([9.0, 9.0, 0.003, -0.004])

            class Truth(dict):
                pass

            truth = Truth(position_error=error)
            truth.time = time
            return SimpleNamespace(truth=truth)

    answers = SimpleNamespace(step=lambda sample: SimpleNamespace(friction_torque=sample + 0.5))
    monkeypatch.setattr(tuning, "efficiency_compensator", lambda crane, efficiency: answers)
    monkeypatch.setattr(tuning, "Simulator", Sea)
    assert tuning._residual("crane", "truth", "leg", 7, 0.8) == pytest.approx(np.sqrt((9e-6 + 16e-6) / 2.0))
