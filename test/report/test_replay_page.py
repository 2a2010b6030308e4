"""The page of a replay: which parameters it draws, and that seed and learned values stand in their own columns."""

import re

import numpy as np
import pytest

from winch_friction.estimation import ParameterEstimate
from winch_friction.physics.signals import Run
from winch_friction.records.model_file import load_model
from winch_friction.replay.recording import Replayed
from winch_friction.report.replay_page import facts, learned_html, next_steps, parameter_plot, sentence, torque_plot
from winch_friction.report.replay_picture import most_learned, replay_figure

SEED = load_model("a6vm215_crane2")
CONTENT = {
    "recording": "r", "samples": 500, "duration_s": 10.0, "active_share": 0.25, "feedforward_rms_Nm": 321.0,
    "feedforward_peak_Nm": 456.0, "accepted_share": 0.9, "nis_share_inside": 0.96,
    "parameters": [{"status": "learned"}, {"status": "seed"}, {"status": "learning"}],
}  # fmt: skip


def learned(**last):
    """Standard deviations that end at these shares of the seed's."""
    time = np.arange(3.0)
    columns = {"time": time}
    for name in SEED.parameter_names:
        columns[name] = np.full(3, SEED.value(name))
        columns[f"{name}_std"] = np.array([1.0, 1.0, last.get(name, 1.0)])
    return Run("r", columns)


def test_the_parameters_that_were_learned_best_come_first():
    assert most_learned(learned(C5=0.2, K1=0.9, C1=0.5), SEED)[:3] == ["C5", "C1", "K1"]


def test_the_sentence_says_what_share_of_the_time_it_was_active_and_how_much_was_learned():
    said = sentence(CONTENT)
    assert "321 N·m RMS, 25 % of the time" in said
    assert "2 of 3 parameters were learned" in said
    known = dict(facts(CONTENT))
    assert known["Largest feedforward"] == "456 N·m"
    assert known["Samples that the estimator took"] == "90.0 %"
    assert known["Innovations inside their 95 % band"] == "96 %"


def test_seed_learned_and_sigma_stand_in_their_columns_in_the_units_that_people_read():
    rpm = np.pi / 30.0
    estimate = ParameterEstimate(
        "C4", "rad/s", value=200.0 * rpm, std=10.0 * rpm, seed_value=300.0 * rpm, seed_std=rpm, status="learned"
    )
    result = Replayed(learned(), learned(), SEED, (estimate,), {})
    row = re.search(r"<tbody><tr>(.*?)</tr>", learned_html(result, SEED)).group(1)
    cells = re.findall(r"<td[^>]*>(.*?)</td>", row)
    assert cells[1:] == ["C4", "300", "200", "10", "rpm", "learned"]


def test_a_recording_without_an_active_feedforward_says_so():
    assert "never active" in sentence({**CONTENT, "active_share": 0.0})


@pytest.mark.parametrize("inside", [None, float("nan")])
def test_an_unknown_consistency_is_not_shown(inside):
    assert dict(facts({**CONTENT, "nis_share_inside": inside}))["Innovations inside their 95 % band"] == ""


def turning(taken):
    """A motor that turns at 100 rad/s, and a feedforward that takes this speed."""
    time, zeros = np.arange(3.0), np.zeros(3)
    fed = Run("c", {"time": time, "friction_torque": zeros, "speed": np.full(3, taken)})
    parameters = {name: values for name, values in learned().columns.items() if name != "time"}
    return fed, Run("e", {"time": time, "friction_torque": zeros, "speed": np.full(3, 100.0), **parameters})


@pytest.mark.parametrize(("taken", "labels"), [(0.0, ["speed"]), (90.0, ["speed", "speed that the feedforward took"])])
def test_a_motor_that_turns_is_drawn_turning_while_the_feedforward_waits(taken, labels):
    """The page drew a speed of zero under runs at 1000 rpm."""
    plot = torque_plot(*turning(taken))
    speeds = [line for line in plot.lines if line.row == 1]
    assert [line.label for line in speeds] == labels
    drawn = plot.frames[speeds[0].frame].columns[speeds[0].y]
    assert drawn == pytest.approx(100.0 * 30.0 / np.pi)
    shown = replay_figure(*turning(taken), SEED).axes[1].lines
    assert shown[1].get_ydata() == pytest.approx(100.0 * 30.0 / np.pi)


@pytest.mark.parametrize(("share", "statuses", "said"), [
    (0.0, ["invalid"], "Log speed_reference"), (0.5, ["learned", "invalid"], "ran to its bound"),
    (0.5, ["seed", "seed"], "Replay a longer recording"), (0.5, ["seed", "frozen"], "Save what was learned"),
])  # fmt: skip
def test_what_to_do_hangs_on_what_was_learned(share, statuses, said):
    content = {**CONTENT, "active_share": share, "parameters": [{"status": each} for each in statuses]}
    (step,) = next_steps(content)
    assert step.startswith(said) or said in step
    assert dict(facts(content))["Recording"] == "10 s, 500 samples"


def test_nothing_learned_is_said():
    assert sentence({**CONTENT, "parameters": [{"status": "seed"}, {"status": "invalid"}]}).endswith(
        "nothing was learned."
    )


def test_what_was_fed_forward_and_what_was_learned_are_drawn_over_the_same_time():
    """Both begin at the recording's first sample, each with its own torque and look."""
    at = np.array([5.0, 6.0, 7.0])
    fed = Run("c", {"time": at, "friction_torque": np.array([1.0, 2.0, 3.0]), "speed": np.full(3, np.pi)})
    own = Run("e", {"time": at + 0.5, "friction_torque": np.array([4.0, 5.0, 6.0]), "speed": np.full(3, 2 * np.pi)})
    plot = torque_plot(fed, own)
    lines = {line.label: (line.row, line.role, *(plot.frames[line.frame].columns[k].tolist() for k in (line.x, line.y)))
             for line in plot.lines}  # fmt: skip
    assert lines["feedforward"] == (0, "after", [0.0, 1.0, 2.0], [1.0, 2.0, 3.0])
    assert lines["friction by the learned model"] == (0, "before", [0.5, 1.5, 2.5], [4.0, 5.0, 6.0])
    assert lines["speed"] == (1, "measured", [0.5, 1.5, 2.5], pytest.approx([60.0] * 3))
    assert lines["speed that the feedforward took"] == (1, "after", [0.0, 1.0, 2.0], pytest.approx([30.0] * 3))


def test_a_learned_parameter_is_drawn_beside_its_seed_with_its_deviation_in_the_units_that_people_read():
    rpm = np.pi / 30.0
    own = Run(
        "e",
        {
            "time": np.array([5.0, 6.0]),
            "C4": np.array([200.0, 210.0]) * rpm,
            "C4_std": np.array([20.0, 10.0]) * rpm,
            "C3": np.ones(2),
            "C3_std": np.ones(2),
        },
    )
    plot = parameter_plot(own, SEED, ["C3", "C4"])
    columns = plot.frames[0].columns
    lines = {(line.label, line.row): line for line in plot.lines}
    assert list(plot.rows) == ["C3 [N·m]", "C4 [rpm]"]
    assert columns["time [s]"].tolist() == [0.0, 1.0]
    assert columns[lines["learned", 1].y] == pytest.approx([200.0, 210.0])
    assert columns[lines["± 1 σ", 1].y] == pytest.approx([180.0, 200.0])
    assert columns[lines["± 1 σ", 1].upper] == pytest.approx([220.0, 220.0])
    assert columns[lines["seed", 1].y] == pytest.approx([SEED.value("C4") / rpm] * 2)
    assert [lines[each, 1].role for each in ("learned", "seed", "± 1 σ")] == ["after", "before", "noise"]


def test_the_picture_shows_parameters_in_deviations_of_their_seed():
    fed, own = turning(90.0)
    moved = {**own.columns, "C4": SEED.value("C4") + np.array([0.0, 1.0, 2.0]), "C4_std": np.array([2.0, 1.0, 0.5])}
    torque, _, below = replay_figure(fed, Run("e", moved), SEED).axes
    assert [line.get_label() for line in torque.lines] == ["feedforward", "learned friction"]
    (line,) = [each for each in below.lines if "(C4)" in each.get_label()]
    assert line.get_ydata() == pytest.approx([0.0, 0.5, 1.0])


def test_a_parameter_without_a_first_deviation_was_not_learned():
    own = learned(C5=0.5)
    own.columns["C1_std"][0], own.columns["C3_std"][0] = np.nan, 0.0
    assert most_learned(own, SEED)[0] == "C5"
    assert len(most_learned(own, SEED)) == 4
