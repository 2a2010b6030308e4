"""Mistakes that a factor puts right, each with the factor that does, and what a channel is in numbers."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.commissioning.check import lone_units
from winch_friction.commissioning.kinematics import range_score
from winch_friction.commissioning.likeliest import likeliest_mistake
from winch_friction.commissioning.mistakes import fixed_mistakes
from winch_friction.commissioning.summaries import summaries
from winch_friction.commissioning.view import RunView
from winch_friction.physics.signals import Run


def seen(speed, **others):
    count = len(speed)
    zeros, ones = np.zeros(count), np.ones(count)
    fields = {
        "name": "r", "time": 0.02 * np.arange(count), "speed": speed, "acceleration": zeros, "load": 5e4 * ones,
        "layer": ones, "radius": ones, "gear_ratio": 250.0, "inertia": 5.0, "motors": 1.0, "max_displacement": 3.4e-5,
        "heave": None, "heave_acceleration": zeros, "groups": {},
    }  # fmt: skip
    return RunView(**(fields | others))


def test_a_speed_of_the_drum_is_turned_by_the_gear_and_one_of_the_motor_by_its_inverse(crane_150t):
    view = seen(np.linspace(1.0, 2.0, 50))
    told = {each.words: each for each in fixed_mistakes([view], crane_150t, {})}
    for words, factor in (
        ("motor_speed holds the drum's speed", crane_150t.gear_ratio),
        ("drum_speed (or its gear ratio) holds the motor's speed", 1.0 / crane_150t.gear_ratio),
    ):
        assert told[words].factor == pytest.approx(factor)
        assert told[words].undo(view).speed == pytest.approx(factor * view.speed)


@pytest.mark.parametrize(
    ("rates", "names"),
    [(("wire_out",), None), (("shaft_angle",), "motor_speed and shaft_angle"),
     (("speed_reference", "shaft_angle"), "motor_speed, speed_reference and shaft_angle")],
)  # fmt: skip
def test_a_sign_of_several_channels_is_that_of_those_that_are_there(rates, names, crane_150t):
    """Of a log without a command or an angle `check` said that it was hardly to be told from these being turned too."""
    view = seen(np.linspace(1.0, 2.0, 50), rates={name: np.ones(50) for name in rates})
    said = [
        m.words.partition("the sign of ")[2].partition(" is flipped")[0] for m in fixed_mistakes([view], crane_150t, {})
    ]
    assert [each for each in said if each.startswith("motor_speed")] == ["motor_speed", *([names] if names else [])]


def test_a_channel_in_numbers_says_what_share_of_it_is_missing():
    values = np.array([1.0, np.nan, 3.0, np.nan])
    (said,) = summaries(Run("r", {"time": np.arange(4.0), "wire_out": values}))
    assert (said.smallest, said.largest, said.missing) == (1.0, 3.0, 0.5)
    (said,) = summaries(Run("r", {"time": np.arange(4.0), "wire_out": values * np.nan}))
    assert np.isnan([said.smallest, said.largest]).all()
    assert (said.missing, said.step) == (1.0, 0.0)


def test_one_channel_far_beyond_the_machine_does_not_outweigh_every_other_sign():
    group = SimpleNamespace(
        drop=np.full(9, 1e7), pressure_sum=np.full(9, 3e7), displacement=np.full(9, 3e-5), torque=np.zeros(9), count=3.0
    )  # fmt: skip
    assert range_score(seen(np.full(9, 1e12), groups={"main": group})) == 400.0


def ports(name, port_a, port_b):
    return Run(name, {"main.pressure_a": np.full(50, port_a), "main.pressure_b": np.full(50, port_b)})


@pytest.mark.parametrize(("port_a", "said"), [(230e5, ["r3"]), (26e5, [])])
def test_ports_that_are_exchanged_hold_no_other_unit(port_a, said):
    """The load's 250 bar at port B are ten times the boost's by chance: "bar under [MPa]" was said of a swap."""
    runs = [ports(f"r{k}", 200e5 + k * 1e5, 25e5) for k in range(3)]
    found = list(lone_units([*runs, ports("r3", port_a, 250e5)]))
    assert [name for each in found for name in each.runs] == said


@pytest.mark.parametrize(("left", "hint"), [(354.0, False), (300.0, True)])
def test_a_mistake_that_closes_next_to_nothing_is_no_hint(left, hint):
    """ "two mistakes ... would close (misfit 399 -> 354)" was said where the limit is 100."""
    closure = SimpleNamespace(run="r1", before=40.0, level=500.0)
    nearest = SimpleNamespace(mistake=SimpleNamespace(words="the ports are swapped"), score=left)
    diagnosis = SimpleNamespace(
        best=None, contradicting=("r1",), names=("r1",), scores=(399.0,), score=399.0, closures=(closure,),
        hypotheses=(nearest,),
    )  # fmt: skip
    (found,) = likeliest_mistake(diagnosis, SimpleNamespace(drive=SimpleNamespace(hydraulic=True)))
    assert ("nearest: the ports are swapped" in found.sentence) is hint


@pytest.mark.parametrize(("holding", "off"), [(("r1",), "r1 is off by 40 N m"), (("r1", "r2"), "r2 is off by 30 N m")])
def test_the_balance_that_proves_a_mistake_is_one_of_the_runs_that_hold_it(holding, off):
    """Of one run of twelve with its ports exchanged: "the torque balance of run_11 is off by 527 N m", a sound one."""
    closures = [
        SimpleNamespace(run=run, score=score, before=before)
        for run, score, before in (("r1", 90.0, 40.0), ("r2", 200.0, 30.0), ("r3", 1.0, 527.0))
    ]
    swapped = SimpleNamespace(words="the ports are swapped", cause="ports", channel="", factor=np.nan)
    best = SimpleNamespace(mistake=swapped, score=3.0, scores=(1.0,) * 3, runs=holding)
    diagnosis = SimpleNamespace(
        best=best, contradicting=holding, names=("r1", "r2", "r3"), scores=(90.0, 200.0, 1.0), score=291.0,
        closures=closures, hypotheses=(best,),
    )  # fmt: skip
    (found,) = likeliest_mistake(diagnosis, SimpleNamespace(drive=SimpleNamespace(hydraulic=True)))
    assert f"(the torque balance of {off} RMS)" in found.sentence
