"""What a replay keeps of a recording: when it looks at the parameters, when a phase begins, and which model it has."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.compensation.config import ReplayConfig
from winch_friction.estimation.answers import Estimate
from winch_friction.physics.signals import GroupSample, Run, Sample
from winch_friction.records.bag_write import MESSAGES
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.topics import crane_topics
from winch_friction.replay.estimator import EstimateRecord
from winch_friction.replay.settings import Phase, ReplaySettings, longest_held, settings_for_rate
from winch_friction.replay.summary import summary
from winch_friction.replay.voices import PAUSE, CompensatorVoice, EstimatorVoice

CRANE, SEED = load_crane("crane_150t"), load_model("a6vm215_crane2")
GROUPS = {"active": GroupSample(50e5, 25e5, 3.4e-5), "passive": GroupSample(275e5, 25e5, 1.1e-5)}
MOVING = Sample(time=0.0, motor_speed=50.0, speed_reference=50.0, hook_load=55e3, groups=GROUPS)


def looked_at(times):
    """The parameter that stands in the row of each time; it is one more at every look."""
    looks = []

    def model():
        looks.append(1)
        return SimpleNamespace(values=(float(len(looks)),), std=np.array([0.1]))

    record = EstimateRecord(SimpleNamespace(model=model, seed=SimpleNamespace(parameter_names=("k",))), period=1.0)
    for time in times:
        record.take(Estimate(time, True, "learning", 0.0, 1.0, 0.0, 1.0, 2.0, 3.0))
    return record.run("r")["k"].tolist()


def test_parameters_are_looked_at_every_second_and_at_the_end():
    assert looked_at([0.0, 0.5, 0.9, 1.0, 1.5, 1.9]) == [1.0, 1.0, 1.0, 2.0, 2.0, 3.0]


def test_a_clock_that_is_set_back_does_not_end_the_looking():
    assert looked_at([1000.0, 10.0, 10.5, 10.6])[:2] == [1.0, 2.0]


def test_the_estimators_numbers_count_the_word_that_its_node_says_in_a_silence():
    own = EstimatorVoice(CRANE, SEED, crane_topics(CRANE), ReplaySettings())
    for time in (100.0, 100.02, 101.0, 101.02):
        for topic, message in crane_topics(CRANE).encode(replace(MOVING, time=time), MESSAGES):
            own.take(SimpleNamespace(source=own.topics.inputs[topic], message=message, receipt=time), time)
    assert own.record.run("r").aside["number"].tolist() == [1, 2, 4, 5]


@pytest.mark.parametrize(("unit", "believed"), [(1.0, True), (1e5, False)])
def test_no_torque_of_inputs_that_contradict_each_other_is_valid_in_a_replay(unit, believed):
    """Its node marks it `invalid`: pressures in bar, while the winch hoists, are none of its drive."""
    own = EstimatorVoice(CRANE, SEED, crane_topics(CRANE), ReplaySettings())
    size, speed = 200, np.full(200, 50.0)
    live = 1.0 + 1e-3 * np.sin(np.arange(size))  # readings that stand still are another doubt
    columns = {"time": 0.02 * np.arange(size), "motor_speed": speed, "speed_reference": speed}
    for name, each in GROUPS.items():
        ports = {"pressure_a": each.pressure_a / unit, "pressure_b": each.pressure_b / unit}
        columns |= {f"{name}.{k}": v * live for k, v in {**ports, "displacement": each.displacement}.items()}
    list(own.take_rows(Run("r", columns)))
    assert bool(own.service.contradiction) != believed
    assert own.record.run("r").aside["valid"].tolist()[-50:] == [believed] * 50


def voice(*phases):
    return CompensatorVoice(CRANE, SEED, crane_topics(CRANE), ReplaySettings(tuple(phases)))


@pytest.mark.parametrize(("silent", "begins"), [(0.02, False), (PAUSE - 0.1, False), (PAUSE + 0.1, True)])
def test_a_phase_without_a_time_begins_after_a_pause(silent, begins):
    own = voice(Phase(), Phase(start=float("nan")))
    assert not own._begins(own._waiting[0], 100.0 + silent), "before the first sample nothing pauses"
    own.service.inputs.last_stamp = 100.0
    assert own._begins(own._waiting[0], 100.0 + silent) is begins


@pytest.mark.parametrize(("stamp", "begins"), [(99.9, False), (100.0, True)])
def test_a_phase_with_a_time_begins_then(stamp, begins):
    own = voice(Phase(), Phase(start=100.0))
    assert own._begins(own._waiting[0], stamp) is begins


def offered(own):
    """The models that its service is offered from now on."""
    found = []
    own.service.offer = found.append
    return found


@pytest.mark.parametrize("follows", [True, False])
def test_a_learned_model_is_taken_where_the_phase_follows_models(follows):
    own = voice(Phase(follow_models=follows))
    found = offered(own)
    own.offer(SEED)
    assert found == [SEED] * follows


def test_a_node_that_begins_afresh_has_the_model_that_was_learned_before(monkeypatch):
    """The topic is latched."""
    own, found = voice(Phase(), Phase()), []
    own.offer(SEED)
    monkeypatch.setattr(CompensatorVoice, "offer", lambda self, model: found.append(model))
    own._begin(Phase())
    assert found == [SEED]


@pytest.mark.parametrize("enabled", [True, False])
def test_a_phase_is_on_or_off_as_it_was_recorded(enabled):
    assert voice(Phase(enabled=enabled)).service.status(0.0)["enabled"] is enabled


def test_the_services_of_a_replay_have_the_settings_that_it_is_given():
    own = ReplaySettings(
        (Phase(config=ReplayConfig(max_age=0.9)),), model_delay=0.3, model_period=7.0, estimator_max_age=0.8,
        watchdog_timeout=0.4, stamp_window=0.6,
    )  # fmt: skip
    topics = crane_topics(CRANE)
    told = [each(CRANE, SEED, topics, own).service for each in (CompensatorVoice, EstimatorVoice)]
    for service in told:
        assert (service.options.watchdog_timeout, service.options.stamp_window) == (0.4, 0.6)
    assert told[0].options.model_delay == told[0].schedule.delay == 0.3
    assert (told[0].inputs.hold.max_age, told[1].inputs.hold.max_age, told[1].model_period) == (0.9, 0.8, 7.0)


@pytest.mark.parametrize(("stamp", "begins"), [(99.9, False), (100.0, True), (101.0, True)])
def test_a_phase_with_a_date_begins_with_it(stamp, begins):
    own = voice(Phase(), Phase(start=100.0))
    assert own._begins(Phase(start=100.0), stamp) is begins


def test_every_phase_notes_what_it_refuses_in_the_one_list():
    own = voice(Phase(), Phase())
    own.service.refuse("of the first")
    own._begin(Phase())
    own.service.refuse("of the second")
    own.offer_text("no: [model", "/friction_model")
    assert own.refused[:2] == ["of the first", "of the second"]
    assert own.refused[2].startswith("/friction_model line 1: not valid YAML")


@pytest.mark.parametrize(
    ("accepted", "torque", "doubted", "valid"),
    [
        (True, 3.0, False, True), (True, 3.0, True, False), (False, 3.0, False, False),
        (True, float("nan"), False, False), (False, float("nan"), False, False),
    ],
)  # fmt: skip
def test_an_answer_is_valid_where_it_was_taken_in_and_shows_a_torque(accepted, torque, doubted, valid):
    model = SimpleNamespace(values=(1.0,), std=np.array([0.1]))
    record = EstimateRecord(SimpleNamespace(model=lambda: model, seed=SimpleNamespace(parameter_names=("k",))))
    record.take(Estimate(0.5, accepted, "learning", 0.1, 0.2, 0.3, 1.0, 2.0, torque), doubted)
    run = record.run("r")
    assert run.aside["valid"].tolist() == [valid]
    names = ("time", "innovation", "innovation_variance", "nis", "speed", "drum_torque", "k", "k_std")
    assert [float(run[name][0]) for name in names] == [0.5, 0.1, 0.2, 0.3, 1.0, 2.0, 1.0, 0.1]


@pytest.mark.parametrize(("silence", "begins"), [(0.9, False), (1.1, True), (-5.0, False)])
def test_a_pause_is_a_second_without_a_sample(silence, begins):
    own = voice(Phase(), Phase(start=float("nan")))
    own.service.inputs.last_stamp = 50.0
    assert own._begins(Phase(start=float("nan")), 50.0 + silence) is begins


# -- what is said of it in a few numbers
def test_a_summary_is_of_the_torque_and_of_what_was_taken_in():
    torque, time = np.array([0.0, -30.0, 40.0, 0.0]), 100.0 + 0.5 * np.arange(4.0)
    given = Run("x", {"time": time, "friction_torque": torque}, aside={"state": np.array(["fading", *3 * ["active"]])})
    states = np.array(["waiting", "rejected", "learning", "stick"])
    found = summary(
        SimpleNamespace(
            compensator=given, estimator=Run("x", {"time": time}, aside={"state": states}), live=(), parameters=(),
            status={"nis_share_inside": 0.9},
        )
    )  # fmt: skip
    assert (found["samples"], found["duration_s"], found["nis_share_inside"]) == (4, 1.5, 0.9)
    assert (found["feedforward_rms_Nm"], found["feedforward_peak_Nm"]) == (25.0, 40.0)
    assert (found["active_share"], found["accepted_share"]) == (0.75, 0.75)


def test_a_log_may_be_as_slow_as_ten_seconds():
    assert longest_held() == 10.0
    settings = settings_for_rate(3.0)
    assert (settings.phases[0].config.max_age, settings.estimator_max_age) == (3.0, 3.0)
