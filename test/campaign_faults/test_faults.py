"""A small seeded draw of the fault campaign, and proof that it notices what it is there to notice."""

from types import SimpleNamespace

import numpy as np
import pytest

from campaign.faults.kinds import KINDS, REFERENCE, SPEED
from campaign.faults.study import one_trial
from campaign.faults.trial import Trial, violations
from campaign.faults.voyages import MESSAGES, voyage
from campaign.faults.watch import OutputWatch, Row


def said(torque, stamp, speed=10.0):
    return SimpleNamespace(friction_torque=torque, speed=speed, time=stamp)


def test_a_draw_of_every_kind_is_safe():
    sailing = voyage("ahc_irregular", 77)
    trial = Trial(sailing, 7, learn=True)
    trial.run(90.0)
    assert trial.draws > 60
    assert violations(trial.rows.values()) == 0, {k: dict(r.violations) for k, r in trial.rows.items()} | {
        "notes": trial.notes
    }
    assert max(row.largest for row in trial.rows.values()) > 100.0  # it did feed forward in between


@pytest.mark.parametrize("number", [51, 341])
def test_a_trial_that_once_found_something_finds_nothing_any_more(number):
    """An input that came long ago under a young stamp; a torque left by a wrong command, a silence and a return."""
    rows, draws, notes = one_trial(number, 1_000_000)
    assert draws > 100
    assert violations(rows.values()) == 0, notes


def test_every_kind_can_be_drawn_and_spoils_something():
    rng = np.random.default_rng(0)
    for name, kind in KINDS.items():
        fault = kind(rng)
        assert fault.kind
        assert callable(fault.spoil), name


@pytest.mark.parametrize(
    ("messages", "wrong"),
    [
        ([(0.0, 0.0, 50.0), (0.02, 0.02, 900.0)], "faster than the slew limit"),
        ([(0.0, 0.0, 50.0), (0.02, 0.02, float("nan"))], "not finite"),
        ([(0.0, 0.0, 2500.0)], "beyond the bound"),
    ],
)
def test_the_watch_sees_what_is_wrong(messages, wrong):
    watch, row = OutputWatch(2000.0, 1.5e4), Row()
    for now, stamp, torque in messages:
        watch.published(said(torque, stamp), now, 10.0, row)
    assert list(row.violations) == [wrong]


def test_a_torque_against_the_motion_is_timed():
    watch, row = OutputWatch(2000.0, 1.5e4), Row()
    for k in range(50):
        watch.published(said(-100.0, 0.02 * k), 0.02 * k, 20.0, row)
    assert row.against == pytest.approx(0.98)
    assert row.violations["against the motion"] == 50 - 1 - 17  # from 0.36 s on


def test_what_shows_the_motion_to_nobody_is_no_violation():
    watch, row = OutputWatch(2000.0, 1.5e4, blind=True), Row()
    for k in range(50):
        watch.blind = k < 10
        watch.published(said(-100.0, 0.02 * k), 0.02 * k, 20.0, row)
    assert not row.violations
    watch.published(said(100.0, 1.0), 1.0, 20.0, row)
    for k in range(51, 80):
        watch.published(said(-100.0, 0.02 * k), 0.02 * k, 20.0, row)
    assert row.violations["against the motion"] > 5


def test_an_output_that_is_obeyed_without_its_input_is_seen():
    """The same trial with a compensator whose age limit does not work."""
    sailing = voyage("ahc_irregular", 77)
    trial = Trial(sailing, 7)
    trial._act = lambda: None  # settings would put the age limit back
    trial.service.inputs.hold.max_age = 1e9
    trial.service.law.output.hold = 1e9
    trial.service.options = type(trial.service.options)(watchdog_timeout=600.0)
    trial.run(60.0)
    assert any("obeyed although an input is gone" in row.violations for row in trial.rows.values())


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_takes_what_another_one_has_emptied(kind):
    """Two faults at once: the second meets messages without values, or none at all."""
    sailing = voyage("ahc_irregular", 77)
    for seed in range(12):
        rng = np.random.default_rng(seed)
        fault = KINDS[kind](rng)
        for tick in range(3):
            encoded = list(sailing.topics.encode(next(iter(sailing.samples)), MESSAGES))
            for topics in ((SPEED, REFERENCE), (SPEED,), ()):
                messages = [(topic, message) for topic, message in encoded if topic in topics]
                for _, message in messages:
                    message.name, message.velocity = ["shaft"] * len(topics[1:]), []
                assert isinstance(fault.spoil(messages, tick, rng), list)
