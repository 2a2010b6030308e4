"""The load that is shown against the motors' torque: what no single sample tells, both ways together do."""

import math
from dataclasses import replace

import pytest
from sea import CRANE, SEED, TOPICS

from winch_friction.online.agreement import Agreement
from winch_friction.online.compensator import CompensatorService
from winch_friction.online.doubt import COMPARED, LEAST_KNOWN, PUSH_SAID, LoadAgainstDrive
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.crane import Drive
from winch_friction.physics.winch.operating_point import ChannelRanges
from winch_friction.records.topics import crane_topics

PERIOD = 0.02  # s
TONNE = 1e3
NAN = math.nan


def at_work(time: float, load: float, friction: float = 0.0, wave: float = 10.0, speed: float = 150.0) -> Sample:
    """Heave compensation of `load` kg with `friction` N m at the shaft: the active group carries what the passive one
    leaves, inertia too."""
    phase = 2.0 * math.pi * time / wave
    omega, acceleration = speed * math.sin(phase), speed * 2.0 * math.pi / wave * math.cos(phase)
    torque = CRANE.drum_torque(load) / CRANE.gear_ratio + CRANE.inertia * acceleration
    torque += math.copysign(friction, omega)
    full = CRANE.max_displacement
    passive = GroupSample(275e5, 25e5, 0.3 * full)
    torque -= 8.0 * passive.displacement * 250e5
    active = GroupSample(max(torque, 0.0) / (3.0 * full) + 25e5, max(-torque, 0.0) / (3.0 * full) + 25e5, full)
    return Sample(time, omega, speed_reference=omega, groups={"active": active, "passive": passive}, hook_load=load)


def said(seconds: float, assumed: float = NAN, **how: float) -> list[str]:
    """What is said of each sample of a sea, with a load of `assumed` kg set; `shown` kg, `rope` N and `out` m are its
    sensors."""
    agreement = Agreement(CRANE, ChannelRanges(CRANE, TOPICS.groups), load=assumed)
    shown, rope, out = (how.pop(name, NAN) for name in ("shown", "rope", "out"))
    found = []
    for k in range(round(seconds / PERIOD)):
        sample = replace(at_work(k * PERIOD, **how), hook_load=shown, rope_force=rope, wire_out=out)
        found.append("; ".join(agreement.contradictions(sample, sample.time)))
    return found


@pytest.mark.parametrize(
    ("load", "shown"), [(55.0, 15.0), (15.0, 55.0), (100.0, 50.0), (55.0, 121.0)], ids=lambda tonnes: f"{tonnes:g} t"
)
def test_a_load_cell_that_is_off_by_less_than_a_dead_one_is_doubted_after_two_waves(load, shown):
    """The last one shows pounds. Each was obeyed for good, its torque marked valid."""
    found = said(25.0, load=load * TONNE, shown=shown * TONNE, friction=300.0)
    assert not any(found[: round(5.0 / PERIOD)])
    assert found[-1] == "hook_load contradicts the drive torque, hoisting and lowering"


# -- from one sample to the next
AT = 60.0  # s


def said_after(change, wave: float = 8.0, at: float = AT) -> float:
    """s after `at` s until something is said of 55 t, with friction of 300 N m; NaN for nothing."""
    agreement = Agreement(CRANE, ChannelRanges(CRANE, TOPICS.groups))
    for k in range(round((at + 60.0) / PERIOD)):
        time = k * PERIOD
        sample = at_work(time, 55e3, friction=300.0, wave=wave)
        if agreement.contradictions(change(sample) if time >= at else sample, time):
            return time - at
    return NAN


def shows(times: float):
    return lambda sample: replace(sample, hook_load=times * sample.hook_load)


@pytest.mark.parametrize("change", [shows(2.0), shows(2.2046), shows(0.45)], ids=["double", "pounds", "less than half"])
@pytest.mark.parametrize("wave", [4.0, 8.0, 12.0])
def test_a_load_cell_that_jumps_is_doubted_as_soon_as_at_the_beginning(change, wave):
    """What was before stood in the means: double was obeyed for 35 s, 7 % more than the friction that there was."""
    assert said_after(change, wave, AT + 0.2 * wave) < 2.0 * LEAST_KNOWN + wave + 1.0


def test_a_load_cell_that_jumps_at_a_reversal_is_doubted_as_soon():
    assert said_after(shows(2.0), 8.0, AT - 0.001) < 2.0 * LEAST_KNOWN + 9.0  # between hoisting and lowering


def test_a_drive_that_jumps_is_doubted_as_soon():
    def double(sample: Sample) -> Sample:
        passive = sample.groups["passive"]
        wrong = GroupSample(passive.pressure_a, passive.pressure_b, 2.0 * passive.displacement)
        return replace(sample, groups={**sample.groups, "passive": wrong})

    assert said_after(double, at=AT + 1.6) < 2.0 * LEAST_KNOWN + 9.0


@pytest.mark.parametrize("load", [15e3, 30e3, 110e3])
def test_a_load_that_is_picked_up_or_set_down_is_none_that_jumps(load):
    """The drive's torque follows the cell, or the cell the drive's torque by as much as a second."""
    for late in (0.0, 1.0, -1.0):
        agreement, found = Agreement(CRANE, ChannelRanges(CRANE, TOPICS.groups)), set()
        for k in range(round(100.0 / PERIOD)):
            time = k * PERIOD
            sample = at_work(time, load if time >= AT + late else 55e3, friction=300.0, wave=8.0)
            shown = load if time >= AT else 55e3
            found.update(agreement.contradictions(replace(sample, hook_load=shown), time))
        assert not found


def test_what_does_not_jump_keeps_what_is_remembered_of_some_waves():
    """A mean over half a wave each way doubts what friction, inertia and noise do within one."""
    watch = LoadAgainstDrive(CRANE, ChannelRanges(CRANE, TOPICS.groups))
    for k in range(round(80.0 / PERIOD)):
        assert watch.contradiction(at_work(k * PERIOD, 55e3, 300.0), PERIOD) == ""
        if k * PERIOD > 40.0:
            assert min(watch._hoisting.known, watch._lowering.known) > COMPARED


def test_a_cell_that_is_wrong_all_the_time_does_not_jump():
    watch = LoadAgainstDrive(CRANE, ChannelRanges(CRANE, TOPICS.groups))
    for k in range(round(60.0 / PERIOD)):
        watch.contradiction(shows(2.0)(at_work(k * PERIOD, 55e3, 300.0)), PERIOD)
        if k * PERIOD > 40.0:
            assert min(watch._hoisting.known, watch._lowering.known) > COMPARED


def test_spikes_do_not_keep_a_cell_from_being_doubted():
    spiky = lambda sample: replace(sample, hook_load=(30e3 if round(sample.time / PERIOD) % 25 == 0 else 121e3))
    assert said_after(spiky) < 40.0


def test_what_shows_the_load_is_named():
    assert said(25.0, load=55e3, rope=15e3 * GRAVITY)[-1].startswith("rope_force contradicts")
    assert said(25.0, 15e3, load=55e3)[-1].startswith("load (the parameter) contradicts")


@pytest.mark.parametrize("wave", [4.0, 10.0, 20.0])
@pytest.mark.parametrize(
    ("load", "friction"), [(300.0, 700.0), (5e3, 1000.0), (16e3, 300.0), (55e3, 700.0), (120e3, 1000.0)]
)
def test_friction_and_inertia_contradict_no_load_cell(load, friction, wave):
    """Two fifths of the load's torque are lost in the gears: that is a bad winch, and no bad load cell. An empty hook
    weighs less than the friction that moves it: after a second of hoisting the feedforward was gone, for good."""
    seconds = max(25.0, 3.0 * wave)  # a wrong one is doubted after two waves
    for error in (0.85, 1.15):
        assert not any(said(seconds, load=load, shown=error * load, friction=friction, wave=wave))


def test_the_wire_beyond_a_cell_at_the_hook_is_no_error_of_it():
    hanging = 40e3 + CRANE.wire_mass * 1500.0
    assert not any(said(40.0, load=hanging, shown=40e3, out=1500.0))
    assert said(40.0, load=hanging, shown=40e3, out=100.0)[-1]


@pytest.mark.parametrize("wrong", [0.0, 15e3])
def test_a_cell_that_was_taken_out_is_not_doubted_for_good(wrong):
    """The load is taken from the pressures then, as on a crane without a cell; only ~/reset had brought it back."""
    service, found = CompensatorService(CRANE, SEED, TOPICS), []
    for k in range(round(60.0 / PERIOD)):
        shown = 55e3 if k * PERIOD < 5.0 else wrong if k * PERIOD < 40.0 else NAN
        given = service.take_row(replace(at_work(k * PERIOD, 55e3, 300.0), hook_load=shown))
        found.append("; ".join(service.contradictions))
    assert found[round(39.0 / PERIOD)]
    assert all(each.startswith("hook_load") for each in found if each)
    assert not found[-1]
    assert given.valid


def test_a_cell_that_works_again_is_believed_again():
    service, found = CompensatorService(CRANE, SEED, TOPICS), []
    for k in range(round(100.0 / PERIOD)):
        sample = at_work(k * PERIOD, 55e3, 300.0)
        service.take_row(replace(sample, hook_load=15e3) if k * PERIOD < 30.0 else sample)
        found.append(bool(service.contradictions))
    assert found[round(30.0 / PERIOD)]
    assert not found[-1]


def turned_by_motors(seconds: float, load: float, shown: float, loss: float, lost_back: float) -> list[str]:
    """What the compensator of a winch with electric motors says: the gear takes `loss` of the load's torque hoisting,
    `lost_back` of it lowering."""
    crane = replace(CRANE, drive=Drive("electric"), groups={}, max_displacement=0.0)
    service, found = CompensatorService(crane, SEED, crane_topics(crane)), []
    for k in range(round(seconds / PERIOD)):
        phase = 2.0 * math.pi * k * PERIOD / 10.0
        held = crane.drum_torque(load) / crane.gear_ratio
        torque = held * (1.0 + loss if math.sin(phase) > 0.0 else 1.0 - lost_back)
        omega = 150.0 * math.sin(phase)
        torque += crane.inertia * 30.0 * math.pi * math.cos(phase)
        service.take_row(
            Sample(k * PERIOD, omega, speed_reference=omega, groups={}, hook_load=shown, motor_torque=torque)
        )
        found.append("; ".join(service.contradictions))
    return found


@pytest.mark.parametrize("shown", [0.0, 25e3, 121e3], ids=lambda shown: f"{shown / TONNE:g} t")
def test_a_load_cell_is_doubted_on_an_electric_winch_as_well(shown):
    """It was obeyed for good: 121 t for 55 t on the hook is 1.8 times the friction, and a winch cycles from 1.3 on."""
    found = turned_by_motors(25.0, 55e3, shown, 0.1, 0.1)
    assert found[-1] == "hook_load contradicts the drive torque, hoisting and lowering"


@pytest.mark.parametrize("load", [2e3, 55e3, 150e3])
def test_a_worm_that_holds_its_load_by_itself_contradicts_no_load_cell(load):
    """It takes as much as the load hoisting, and a little more lowering, where the motor has to push."""
    assert not any(turned_by_motors(60.0, load, 1.1 * load, 1.0, 1.1))


# -- what the two of them cannot be
def scaled(group: str, pressure: float = 1.0, displacement: float = 1.0):
    """A sample of which one group's pressures and displacement are shown so many times as large."""

    def change(sample: Sample) -> Sample:
        a, b, d = (getattr(sample.groups[group], name) for name in ("pressure_a", "pressure_b", "displacement"))
        wrong = GroupSample(pressure * a, pressure * b, displacement * d)
        return replace(sample, groups={**sample.groups, group: wrong})

    return change


def exchanged(sample: Sample) -> Sample:
    """The feedbacks of both groups on each other's topic."""
    one, other = sample.groups["active"], sample.groups["passive"]
    swapped = {
        "active": GroupSample(one.pressure_a, one.pressure_b, other.displacement),
        "passive": GroupSample(other.pressure_a, other.pressure_b, one.displacement),
    }
    return replace(sample, groups=swapped)


@pytest.mark.parametrize("at", [0.0, AT], ids=["from the beginning", "later"])
def test_pressures_that_make_the_load_appear_half_as_large_again_are_doubted(at):
    """0.9 of what is then taken for the friction was 1.26 of it, and from 1.3 on a winch may cycle; up to 1.67 times
    the load was obeyed for good, 636 for 530 N m."""
    assert said_after(scaled("passive", pressure=1.6), at=at) < 2.0 * LEAST_KNOWN + 9.0


@pytest.mark.parametrize("at", [0.0, AT + 0.1], ids=["from the beginning", "later"])
def test_displacements_of_two_groups_that_are_exchanged_are_doubted_within_a_wave(at):
    """Lowering, friction can only take from the torque: three times the load is neither friction nor inertia. 828 for
    530 N m went out for 15 s."""
    assert said_after(exchanged, at=at) < 8.0


@pytest.mark.parametrize(("change", "within"), [(shows(2.6), 8.0), (shows(0.25), 8.0)], ids=["above", "below"])
def test_a_cell_that_friction_cannot_explain_is_doubted_within_a_wave(change, within):
    def on_the_outer_layer(sample: Sample) -> Sample:
        return replace(change(sample), wire_layer=6.0)

    assert said_after(on_the_outer_layer, at=AT + 0.2) < within


@pytest.mark.parametrize("change", [shows(2.0), shows(0.5)], ids=["double", "half"])
@pytest.mark.parametrize("rest", [2.0, 20.0, 300.0])
def test_a_cell_that_jumps_at_rest_is_doubted_as_soon_as_one_that_jumps_in_motion(change, rest):
    """What was before stood in the means for 25 to 38 s of motion."""
    agreement = Agreement(CRANE, ChannelRanges(CRANE, TOPICS.groups))
    for k in range(round(AT / PERIOD)):
        assert not agreement.contradictions(at_work(k * PERIOD, 55e3, 300.0, 8.0), k * PERIOD)
    told = NAN
    for k in range(round((rest + 40.0) / PERIOD)):
        time = AT + k * PERIOD
        moving = max(k * PERIOD - rest, 0.0)
        sample = at_work(moving, 55e3, 300.0, 8.0) if moving else replace(at_work(0.0, 55e3), motor_speed=0.0)
        found = agreement.contradictions(change(replace(sample, time=time)), time)
        told = moving if found and math.isnan(told) else told
    assert told < 2.0 * LEAST_KNOWN + 9.0


@pytest.mark.parametrize("layer", [1.0, 3.0, 6.0])
def test_a_layer_that_nobody_says_contradicts_no_load(layer):
    """The outer one is taken for it; on the innermost one of this drum the load pulls with 0.7 of that."""
    inner = CRANE.drum.radius(layer) / CRANE.drum.radius(NAN)
    assert not any(said(40.0, load=inner * 120e3, shown=120e3, friction=300.0))
    assert said(40.0, load=0.4 * 120e3, shown=120e3, friction=300.0)[-1]
    assert said(40.0, load=120e3, shown=inner * 70e3 * 0.8, friction=300.0)[-1]


def test_a_doubt_stands_while_friction_may_explain_what_it_was_raised_for():
    """Hoisting, three times the load may be friction: the feedforward came back with each half-wave that went so."""
    agreement, found = Agreement(CRANE, ChannelRanges(CRANE, TOPICS.groups)), []
    for k in range(round(20.0 / PERIOD)):
        found.append(bool(agreement.contradictions(exchanged(at_work(k * PERIOD, 55e3, 300.0, 8.0)), k * PERIOD)))
    assert all(found[found.index(True) :])


@pytest.mark.parametrize("wave", [4.0, 10.0, 20.0])
def test_a_speed_of_the_wrong_sign_makes_friction_push_and_is_doubted_without_a_wire_counter(wave):
    """Command and speed of one program: 530 N m pushed with full force against each motion, for good."""

    def turned(sample: Sample) -> Sample:
        return replace(sample, motor_speed=-sample.motor_speed, speed_reference=-sample.speed_reference)

    agreement, found = Agreement(CRANE, ChannelRanges(CRANE, TOPICS.groups)), []
    for k in range(round(max(25.0, 2.0 * wave) / PERIOD)):
        found.append(agreement.contradictions(turned(at_work(k * PERIOD, 55e3, 300.0, wave)), k * PERIOD))
    assert found[-1] == (PUSH_SAID,)
