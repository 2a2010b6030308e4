"""The feedforward law and the rules of docs/physics.md §4."""

import math
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.compensation.parts import FrictionLaw
from winch_friction.compensation.safe_output import LONGEST_AGAINST, LONGEST_LAG, SafeOutput
from winch_friction.physics.channels import BAR, CM3_PER_REV
from winch_friction.physics.errors import InputError, from_mapping
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch import sample_operating_point
from winch_friction.physics.winch.operating_point import ChannelRanges, fastest_command
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

CRANE = load_crane("crane_150t")
SEED = load_model("a6vm215_crane1")
PERIOD = 0.02


def ahc_sample(time, speed, *, hook_load=55e3, pressure=120 * BAR, displacement=215 * CM3_PER_REV):
    groups = {
        "active": GroupSample(pressure + 25 * BAR, 25 * BAR, displacement),
        "passive": GroupSample(160 * BAR, 30 * BAR, 215 * CM3_PER_REV),
    }
    return Sample(time, speed, speed_reference=speed, groups=groups, hook_load=hook_load)


def compensator(**settings):
    return FeedforwardCompensator(CRANE, SEED, CompensatorConfig(**{"ramp_time": 0.2, **settings}))


def run_up(each, speed=100.0, until=1.0, **channels):
    """Constant speed long enough to be fully faded in; returns the outputs and the next time."""
    times = np.arange(0.0, until, PERIOD)
    return [each.step(ahc_sample(t, speed, **channels)) for t in times], float(times[-1] + PERIOD)


def model_torque(model, sample, speed):
    drum_torque = CRANE.drum_torque(sample.hook_load, sample.wire_layer)
    return float(model.torque(sample_operating_point(sample, CRANE, drum_torque=drum_torque, speed=speed)))


def test_is_the_scaled_friction_of_the_model_and_its_pressure_on_the_active_group():
    each = compensator(scale=0.85)
    outputs, _ = run_up(each)
    expected = 0.85 * model_torque(SEED, ahc_sample(0.0, 100.0), 100.0)
    assert outputs[-1].state == "active"
    assert outputs[-1].friction_torque == pytest.approx(expected, rel=1e-12)
    assert outputs[-1].pressure == pytest.approx(expected / (3 * 215 * CM3_PER_REV), rel=1e-12)


def test_gains_act_term_by_term():
    without = compensator(gains={"stribeck": 0.0}, scale=1.0)
    outputs, _ = run_up(without, speed=5.0)
    reduced = SEED.subset([name for name in SEED.term_names if name != "stribeck"])
    expected = model_torque(reduced, ahc_sample(0.0, 5.0), 5.0) * math.tanh(5.0 / 3.0)
    assert outputs[-1].friction_torque == pytest.approx(expected, rel=1e-9)


def test_extrapolates_a_sine_reference_by_the_lead():
    each = compensator(lead=0.1, scale=1.0)
    omega = 2 * math.pi / 10
    errors = []
    for time in np.arange(0.0, 20.0, PERIOD):
        out = each.step(ahc_sample(time, 200 * math.sin(omega * time)))
        errors.append(out.speed - 200 * math.sin(omega * (time + 0.1)))
    assert max(map(abs, errors[50:])) < 0.1  # rad/s of 200; without extrapolation 12.6


def test_reversal_is_spread_over_the_reversal_time():
    each = compensator(reversal_time=0.05)
    torques = [each.step(ahc_sample(t, -130.0 * (t - 2.0))).friction_torque for t in np.arange(0.0, 4.0, PERIOD)]
    steps = np.abs(np.diff(torques[60:]))
    assert torques[60] > 0.0 > torques[-1]
    assert steps.max() < 0.35 * (torques[60] - torques[-1])  # a sign would do it in one step


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_estimates_the_load_from_the_pressures_when_there_is_no_load_cell(scale):
    """By the whole friction, however little of it is compensated."""
    speed = 100.0
    friction = model_torque(SEED, ahc_sample(0.0, speed), speed)
    held = CRANE.drum_torque(55e3) / CRANE.gear_ratio + friction
    passive = 8 * 215 * CM3_PER_REV * 130 * BAR
    pressure = (held - passive) / (3 * 215 * CM3_PER_REV)
    each = compensator(scale=scale, load_filter=1.0)
    outputs, _ = run_up(each, speed=speed, hook_load=math.nan, pressure=pressure, until=20.0)
    assert outputs[-1].drum_torque == pytest.approx(CRANE.drum_torque(55e3), rel=0.01)


# -- limits
def test_never_leaves_the_seed_envelope_nor_the_absolute_limit():
    hot = SEED.with_values({"C6": SEED.value("C6") * 1.5, "C1": SEED.value("C1") * 1.5, "K4": SEED.value("K4") * 1.5})
    each = compensator(scale=1.3)
    each.load_model(hot)
    outputs, _ = run_up(each)
    assert outputs[-1].friction_torque == pytest.approx(1.3 * model_torque(SEED, ahc_sample(0.0, 100.0), 100.0))
    assert each.status()["envelope_clamps"] > 0
    tight = compensator(absolute_limit=50.0)
    outputs, _ = run_up(tight, speed=-100.0)
    assert outputs[-1].friction_torque == -50.0


def test_other_settings_leave_the_envelope_around_the_seed_and_not_around_the_model_in_use():
    hot = SEED.with_values({"C6": SEED.value("C6") * 1.5, "C1": SEED.value("C1") * 1.5, "K4": SEED.value("K4") * 1.5})
    each = compensator(scale=1.3)
    each.load_model(hot)
    each.configure(CompensatorConfig(scale=1.3, ramp_time=0.2, lead=0.01))
    outputs, _ = run_up(each)
    assert outputs[-1].friction_torque == pytest.approx(1.3 * model_torque(SEED, ahc_sample(0.0, 100.0), 100.0))


def test_a_narrow_envelope_leaves_the_slew_that_a_reversal_of_the_whole_friction_needs():
    limits = []
    for envelope in (0.5, 1.0, 1.3):
        each = compensator(envelope=envelope, reversal_time=0.5)
        run_up(each, until=0.1)
        limits.append(each.status()["slew_limit"])
    assert limits[0] == pytest.approx(limits[1])
    assert limits[2] == pytest.approx(1.3 * limits[1])


def test_no_setting_leaves_more_than_a_third_beyond_the_seed():
    """`envelope` could be set to 2 at a running node: with gains of 1.5 a torque of twice the seed's went out."""
    with pytest.raises(InputError, match=r"envelope must be 0 \.\.\. 1\.3, found 1\.31"):
        CompensatorConfig(envelope=1.31)
    each = compensator(scale=1.3, gains=dict.fromkeys(SEED.term_names, 1.5))
    outputs, _ = run_up(each)
    assert outputs[-1].friction_torque == pytest.approx(1.3 * model_torque(SEED, ahc_sample(0.0, 100.0), 100.0))


def test_slew_limit_bounds_every_step():
    each = compensator(slew_limit=1000.0)
    rng = np.random.default_rng(5)
    torques = [each.step(ahc_sample(k * PERIOD, s)).friction_torque for k, s in enumerate(rng.normal(0, 100, 300))]
    assert np.abs(np.diff(torques)).max() <= 1000.0 * PERIOD * (1 + 1e-9)
    assert each.status()["slew_clamps"] > 0


# -- lost inputs
@pytest.mark.parametrize("lost", ["reference", "pressure", "displacement", "groups", "layer"])
def test_a_lost_input_ramps_to_zero_and_back_without_a_bump(lost):
    each = compensator()
    outputs, time = run_up(each)
    torques = [outputs[-1].friction_torque]
    for k in range(60):
        sample = ahc_sample(time + k * PERIOD, 100.0 if k < 20 else -100.0)
        if k < 30:
            _lose(sample, lost)
        out = each.step(sample)
        torques.append(out.friction_torque)
        if k == 29:
            assert out.state == "stale"
            assert out.friction_torque == 0.0
    assert torques[-1] < -0.9 * torques[0]
    assert np.abs(np.diff(torques)).max() < 0.12 * torques[0]  # ramp of 0.2 s in steps of 0.02 s


def _lose(sample, what):
    if what == "reference":
        sample.speed_reference = math.nan
    elif what == "layer":
        sample.wire_layer = 7.0
    elif what == "groups":
        sample.groups.clear()
    else:
        setattr(sample.groups["passive"], "pressure_a" if what == "pressure" else what, math.nan)


def test_returning_in_the_middle_of_the_ramp_with_the_opposite_sign_is_bumpless():
    each = compensator(ramp_time=1.0)
    outputs, time = run_up(each, until=2.0)
    torques = [outputs[-1].friction_torque]
    for k in range(120):
        sample = ahc_sample(time + k * PERIOD, 100.0 if k < 10 else -100.0)
        if k < 10:
            _lose(sample, "pressure")
        torques.append(each.step(sample).friction_torque)
    # 0.8 of it are left, let go within 0.2 s: it pushes against a motion that is known
    assert np.abs(np.diff(torques)).max() < 4.5 * PERIOD * abs(torques[0])
    assert torques[-1] == pytest.approx(-torques[0], rel=1e-9)


def test_silence_fades_the_output():
    each = compensator(max_age=0.1)
    outputs, _ = run_up(each)
    last = outputs[-1]
    assert each.decay(last.time + 0.09).friction_torque == last.friction_torque
    half = each.decay(last.time + 0.2)
    assert half.friction_torque == pytest.approx(0.5 * last.friction_torque)
    assert half.pressure == pytest.approx(0.5 * last.pressure)
    assert (half.state, half.valid) == ("stale", False)
    assert each.decay(last.time + 5.0).friction_torque == 0.0


def test_a_silent_spell_counts_as_expired_whether_or_not_a_watchdog_looked():
    each = compensator()
    _, time = run_up(each)
    out = each.step(ahc_sample(time + 5.0, 100.0))
    assert abs(out.friction_torque) < 1e-9
    assert out.state == "fading"


def test_time_stepping_back_holds_the_output_for_that_sample_and_carries_on():
    each = compensator()
    outputs, _ = run_up(each)
    out = each.step(ahc_sample(0.0, 100.0))
    assert out.friction_torque == outputs[-1].friction_torque
    assert each.step(ahc_sample(PERIOD, 100.0)).friction_torque == pytest.approx(out.friction_torque)
    assert each.status()["time_steps_back"] == 1


def test_nan_and_infinity_never_leave():
    each = compensator()
    rng = np.random.default_rng(3)
    values = [math.nan, math.inf, -math.inf, 1e308, -1e308, 0.0, 1e-308]
    for k in range(600):
        sample = ahc_sample(k * PERIOD, 100.0)
        for target, name in _channels(sample):
            if rng.random() < 0.15:
                setattr(target, name, values[rng.integers(len(values))])
        out = each.step(sample)
        assert math.isfinite(out.friction_torque)
        assert math.isfinite(out.pressure)
        assert abs(out.friction_torque) <= CRANE.absolute_torque_limit
    outputs = [each.step(ahc_sample(12.0 + k * PERIOD, 100.0)) for k in range(50)]
    assert outputs[-1].state == "active"


def _channels(sample):
    yield from ((sample, name) for name in ("time", "motor_speed", "speed_reference", "hook_load"))
    for group in sample.groups.values():
        yield from ((group, name) for name in ("pressure_a", "pressure_b", "displacement"))


# -- models
def test_a_model_swap_is_bumpless_and_arrives():
    each = compensator(ramp_time=0.5)
    _, time = run_up(each, until=2.0)
    learned = SEED.with_values({"C6": SEED.value("C6") * 1.3})
    before = each.step(ahc_sample(time, 100.0)).friction_torque
    each.load_model(learned)
    torques = [each.step(ahc_sample(time + (k + 1) * PERIOD, 100.0)).friction_torque for k in range(60)]
    target = 0.9 * model_torque(learned, ahc_sample(0.0, 100.0), 100.0)
    assert torques[-1] == pytest.approx(target, rel=1e-9)
    assert np.abs(np.diff([before, *torques])).max() <= 1.01 * (target - before) * PERIOD / 0.5


@pytest.mark.parametrize("change", [1.0, 1.05])
def test_a_model_swap_in_a_reversal_carries_over_no_more_than_the_models_differ(change):
    """What the motion changes within the sample is not the models' difference: half the torque had been carried along
    for a ramp time."""
    other = SEED.with_values({"C6": SEED.value("C6") * change})
    largest = 0.0
    for swap in range(40, 60):
        swapped, plain = compensator(ramp_time=1.0), compensator(ramp_time=1.0)
        for each in (swapped, plain):
            run_up(each, until=2.0)
        for k in range(110):
            if k == swap:
                swapped.load_model(other)
            sample = ahc_sample(2.0 + k * PERIOD, 100.0 * math.cos(math.pi * k / 100.0))
            one, two = swapped.step(sample), plain.step(sample)
            largest = max(largest, abs(one.friction_torque - two.friction_torque))
    assert largest <= (change - 1.0) * 1.5 * abs(two.friction_torque) + 1e-9


@pytest.mark.parametrize("factor", [0.49, 1.51])
def test_a_model_outside_half_the_seed_is_refused_and_the_last_good_one_kept(factor):
    each = compensator()
    good = SEED.with_values({"C6": SEED.value("C6") * 1.2})
    each.load_model(good)
    with pytest.raises(InputError, match="K4 .*last good model is kept"):
        each.load_model(SEED.with_values({"K4": SEED.value("K4") * factor}))
    assert each.model is good
    assert each.status()["refused_models"] == 1


def test_disabling_fades_out_and_enabling_fades_in():
    each = compensator()
    outputs, time = run_up(each)
    each.set_enabled(False)
    off = [each.step(ahc_sample(time + k * PERIOD, 100.0)) for k in range(20)]
    assert off[-1].state == "disabled"
    assert off[-1].friction_torque == 0.0
    assert np.abs(np.diff([outputs[-1].friction_torque, *(o.friction_torque for o in off)])).max() < 0.11 * abs(
        outputs[-1].friction_torque
    )
    each.set_enabled(True)
    on = [each.step(ahc_sample(time + 1 + k * PERIOD, 100.0)) for k in range(20)]
    assert on[-1].friction_torque == pytest.approx(outputs[-1].friction_torque)


# -- configuration
def test_measured_speed_on_a_torque_commanded_drive_is_refused_unless_very_smooth():
    with pytest.raises(InputError, match="reversal_speed"):
        CompensatorConfig(drive="torque", velocity_source="measured")
    CompensatorConfig(drive="torque", velocity_source="measured", reversal_speed=80.0)
    CompensatorConfig(drive="torque", velocity_source="reference")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({"scal": 0.9}, "unknown key 'scal'"),
        ({"scale": 2.0}, "scale must be 0 ... 1.3"),
        ({"scale": math.nan}, "scale must be"),
        ({"scale": True}, "scale must be a number"),
        ({"velocity_source": "guessed"}, "must be one of reference, measured"),
        ({"gains": {"stribeck": "much"}}, "gains.stribeck must be a number"),
        ({"gains": 1.0}, "gains must be a mapping"),
    ],
)
def test_wrong_settings_are_refused_in_one_line(content, said):
    with pytest.raises(InputError, match=said) as caught:
        from_mapping(CompensatorConfig, content, "compensator.yaml")
    assert str(caught.value).startswith("compensator.yaml: ")
    assert "\n" not in str(caught.value)


def test_gains_for_unknown_terms_are_refused():
    with pytest.raises(InputError, match="there is no term 'strobeck'"):
        compensator(gains={"strobeck": 1.0})


def test_a_load_that_a_load_cell_could_not_show_is_none_that_may_be_set():
    """900 t on a winch of 12 t: the feedforward was at the absolute limit for the second until the drive's torque
    contradicted it."""
    refused = r"^load 300001 kg is more than this crane can have \(300000 kg\); is it in kg\?$"
    with pytest.raises(InputError, match=refused):
        compensator(load=300_001.0)
    running = compensator(load=300_000.0)
    with pytest.raises(InputError, match=refused):
        running.configure(CompensatorConfig(load=300_001.0, scale=0.3))
    assert running.config.scale != 0.3


def test_what_only_a_sensor_shows_is_not_compensated():
    model = load_model("emps_symmetric")
    each = FeedforwardCompensator(load_crane("emps"), model, CompensatorConfig(scale=1.0, ramp_time=0.1))
    for k in range(50):
        sample = Sample(k * 0.01, 0.5, speed_reference=0.5, motor_torque=1.0)
        out = each.step(sample)
    width = each.config.reversal_speed
    assert out.friction_torque == pytest.approx((20.39 + 203.5 * 0.5) * math.tanh(0.5 / width))


def test_a_hydraulic_model_is_refused_on_an_electric_drive():
    each = FeedforwardCompensator(load_crane("emps"), load_model("emps_symmetric"))
    with pytest.raises(InputError, match="need pressures, the crane's drive is electric"):
        each.load_model(replace(SEED, name="wrong crane"))


def test_the_envelope_bounds_what_is_published_below_the_absolute_limit():
    output = SafeOutput(absolute=2000.0, slew=1e6, ramp_time=0.2, hold=0.1)
    for k in range(100):
        output.arrive(k * PERIOD)
        output.follow(-900.0, 300.0 if k < 50 else 5000.0, usable=True, enabled=True)
        assert output.torque >= (-300.0 if k < 50 else -900.0)
        if k == 49:
            assert output.torque == -300.0
    assert output.torque == pytest.approx(-900.0)


def _faded(stamps_per_second, jitter=0.0):
    """Torques by the steady clock after an input is lost at 1 s, from when on stamps run so fast."""
    output = SafeOutput(absolute=1000.0, slew=2000.0, ramp_time=0.5, hold=0.1)
    rng, stamp, found = np.random.default_rng(3), 0.0, []
    for k in range(150):
        now, lost = k * PERIOD + jitter * float(rng.uniform(-1.0, 1.0)), k * PERIOD > 1.0
        stamp += PERIOD * (stamps_per_second if lost else 1.0)
        output.arrive(stamp, now)
        found.append(output.follow(200.0, 1000.0, usable=not lost, enabled=True, motion=50.0))
    return np.array(found)


def test_stamps_that_run_slowly_do_not_hold_up_a_fade():
    slow, ordinary = _faded(0.3), _faded(1.0)
    at = np.arange(150) * PERIOD
    assert ordinary[at <= 1.0].max() == pytest.approx(200.0)
    assert at[np.flatnonzero(slow == 0.0)[-1]] > 2.0, "it stays there"
    assert slow[at > 1.0 + 0.1 + 0.5 + 3 * PERIOD].max() == 0.0
    assert np.abs(np.diff(slow)).max() <= 2000.0 * (0.1 + 2 * PERIOD)


def test_a_network_that_jitters_within_the_age_limit_changes_nothing():
    np.testing.assert_array_equal(_faded(1.0, jitter=0.02), _faded(1.0))


def _carrying() -> SafeOutput:
    """After 100 samples that ask for -350 N m, with stamps from 1000 s on and the clock from 0."""
    output = SafeOutput(absolute=1000.0, slew=15_000.0, ramp_time=0.3, hold=0.1)
    for k in range(100):
        output.arrive(1000.0 + k * PERIOD, k * PERIOD)
        output.follow(-350.0, 1000.0, usable=True, enabled=True, motion=-50.0)
    return output


@pytest.mark.parametrize("waited", [0.02, 0.04, 3.0])
def test_a_clock_that_is_set_back_leaves_no_dip(waited):
    """The motion goes on as before, and so does what is published: what fades in is what is let go, from the start."""
    output = _carrying()
    assert output.torque == pytest.approx(-350.0)
    output.restart()
    for k in range(30):
        output.arrive(k * PERIOD, 99 * PERIOD + waited + k * PERIOD)
        assert output.follow(-350.0, 1000.0, usable=True, enabled=True, motion=-50.0) == pytest.approx(-350.0)


@pytest.mark.parametrize("waited", [0.02, 0.04, 3.0])
def test_a_clock_that_is_set_once_makes_no_step(waited):
    """Whatever the motion is by then: the first sample after it says what was said last."""
    output = _carrying()
    output.restart()
    output.arrive(0.0, 99 * PERIOD + waited)
    assert output.follow(340.0, 1000.0, usable=True, enabled=True, motion=50.0) == pytest.approx(-350.0)
    output.arrive(PERIOD, 100 * PERIOD + waited)
    assert output.follow(340.0, 1000.0, usable=True, enabled=True, motion=50.0) > -350.0


def test_time_that_a_ramp_has_used_is_not_used_again():
    """Stamps run slowly, the watchdog ramps between two samples: no pair lies further apart than the slew limit."""
    output = SafeOutput(absolute=1000.0, slew=2000.0, ramp_time=0.5, hold=0.1)
    stamp, now, said = 0.0, 0.0, [(0.0, 0.0)]
    for k in range(400):
        stamp, now = stamp + (PERIOD if k < 60 else 0.3 * PERIOD), now + PERIOD
        lost = k > 60 and k % 7 > 3
        if k > 60 and k % 9 == 0:  # half a second without a sample; the watchdog speaks shortly before the next
            stamp, now = stamp + 0.15, now + 0.5
            output.decay(stamp)
            said.append((now, output.torque))
            stamp, now = stamp + 0.001, now + 0.001
        output.arrive(stamp, now)
        said.append((now, output.follow(600.0, 1000.0, usable=not lost, enabled=True, motion=-50.0 if lost else 50.0)))
    at, torque = np.array(said).T
    assert np.abs(torque).max() > 100.0
    assert np.all(np.abs(np.diff(torque)) <= 2000.0 * np.maximum(np.diff(at), 1e-3) + 1e-6)


def test_a_gap_that_an_age_limit_of_seconds_allows_counts_as_half_a_second_of_fading():
    """A log of one sample in two seconds: what fades in over four takes eight samples, not two."""
    output = SafeOutput(absolute=1000.0, slew=1e6, ramp_time=4.0, hold=5.0)
    faded = []
    for k in range(4):
        output.arrive(2.0 * k)
        output.follow(100.0, math.inf, usable=True, enabled=True)
        faded.append(output.fade.value)
    assert faded == pytest.approx([0.0, 0.125, 0.25, 0.375])


@pytest.mark.parametrize(
    ("term", "channel"), [("viscosity_temperature", "oil_temperature"), ("torque_ripple", "shaft_angle")]
)
def test_what_a_term_reads_is_an_input_that_can_be_lost(term, channel):
    """A ripple at an angle that nobody says would be a torque of one direction."""
    more = term_named(term)
    values = (*SEED.values, *(each.typical for each in more.parameters))
    each = FeedforwardCompensator(CRANE, replace(SEED, terms=(*SEED.terms, more), values=values, covariance=None))
    known = replace(ahc_sample(0.0, 100.0), **{channel: 30.0})
    assert each.step(known).valid
    lost = each.step(ahc_sample(PERIOD, 100.0))
    assert not lost.valid
    assert each.status()["missing"] == channel


@pytest.mark.parametrize("begin", [0.0, 1.7e9])
def test_a_sample_that_comes_just_in_time_is_no_silence(begin):
    """Ten samples a second, and an age of a tenth of one: what is left is the rounding of the stamps."""
    slow, quick = (compensator(max_age=age) for age in (0.1, 0.2))
    for k in range(40):
        speed = 100.0 * math.sin(0.1 * k)
        outputs = [each.step(ahc_sample(begin + 0.1 * k, speed)) for each in (slow, quick)]
        assert outputs[0].friction_torque == pytest.approx(outputs[1].friction_torque, abs=0.01)
    assert outputs[0].state == "active"


# -- what is set and what is told
@pytest.mark.parametrize(("width", "taken"), [(74.9, False), (75.0, True)])
def test_a_torque_commanded_drive_on_measured_speed_needs_a_width_of_75_rad_s(width, taken):
    with nullcontext() if taken else pytest.raises(InputError, match=f"at least 75 rad/s .found {width:g}"):
        CompensatorConfig(drive="torque", velocity_source="measured", reversal_speed=width)


@pytest.mark.parametrize("name", ["motor_speed", "active.pressure_a", "main.displacement", "speed_reference"])
def test_what_turns_with_every_wave_is_no_older_than_half_a_second(name):
    CompensatorConfig(max_age=0.5, max_ages={name: 0.5, "hook_load": 60.0, "oil_temperature": 3600.0})
    with pytest.raises(InputError, match="max_age must be 0.001 ... 0.5 s"):
        CompensatorConfig(max_age=0.51)
    with pytest.raises(InputError, match=f"max_ages.{name} must be at most 0.5 s, found 0.51"):
        CompensatorConfig(max_ages={name: 0.51})


@pytest.mark.parametrize("age", [0.0, 0.0009, 3601.0])
def test_an_input_that_may_have_no_age_at_all_or_an_endless_one_is_refused(age):
    """Of no age is no value but at the instant of its own message: no torque would ever come."""
    with pytest.raises(InputError, match="max_ages"):
        CompensatorConfig(max_ages={"hook_load": age})
    assert CompensatorConfig(max_ages={"hook_load": 0.001}).max_ages["hook_load"] == 0.001


@pytest.mark.parametrize(("limit", "bound"), [(math.inf, 2000.0), (1e4, 2000.0), (700.0, 700.0)])
def test_a_limit_that_is_set_is_never_above_the_cranes_own(limit, bound):
    each = compensator(absolute_limit=limit, slew_limit=1e6)
    assert each.status()["torque_limit"] == bound == each.output.absolute
    each.configure(CompensatorConfig(absolute_limit=limit, slew_limit=1e6))
    assert each.output.absolute == bound


def test_a_look_ahead_that_is_set_while_it_runs_is_looked():
    each = compensator()
    for lead in (0.0, 0.2):
        each.configure(CompensatorConfig(lead=lead, jerk_filter=0.0))
        outs = [each.step(ahc_sample(10.0 * lead + t, 50.0 + 30.0 * t)) for t in PERIOD * np.arange(20)]
        assert outs[-1].speed == pytest.approx(50.0 + 30.0 * (19 * PERIOD + lead))


@pytest.mark.parametrize(("source", "channel"), [("measured", "motor_speed"), ("reference", "speed_reference")])
def test_another_source_of_the_speed_is_another_input_that_is_needed(source, channel):
    each = compensator(velocity_source="measured" if source == "reference" else "reference")
    each.configure(CompensatorConfig(velocity_source=source))
    for name in ("motor_speed", "speed_reference"):
        out = each.step(replace(ahc_sample(0.0, 50.0), **{name: math.nan}))
        assert out.valid is (name != channel)
        assert each.status()["missing"] == (channel if name == channel else "")


def test_a_model_that_is_taken_over_needs_what_its_terms_read():
    each, more = compensator(), term_named("viscosity_temperature")
    values = (*SEED.values, *(parameter.typical for parameter in more.parameters))
    each.load_model(replace(SEED, terms=(*SEED.terms, more), values=values, covariance=None))
    assert not each.step(ahc_sample(0.0, 100.0)).valid
    assert each.status()["missing"] == "oil_temperature"


@pytest.mark.parametrize("acceleration", [-400.0, -20.0, 20.0, 400.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_sign_is_as_wide_as_the_acceleration_either_way_asks_for(acceleration, side):
    """... and no narrower than the reversal speed: 400 rad/s^2 over 0.05 s are 20 rad/s, 20 rad/s^2 hardly one."""
    each = compensator(scale=1.0, reversal_time=0.05, reversal_speed=3.0)
    speed = 5.0 * side
    for k in range(-50, 1):
        each.step(ahc_sample(1.0 + k * PERIOD, speed + acceleration * k * PERIOD))
    width = max(3.0, 0.05 * abs(acceleration))
    sample = ahc_sample(1.0, speed)
    full = sample_operating_point(sample, CRANE, drum_torque=CRANE.drum_torque(55e3), speed=speed)
    torque = float(SEED.torque((math.tanh(speed / width), *full[1:])))
    assert each._target.torque == pytest.approx(torque, rel=1e-6)
    assert each.status()["drum_torque"] == CRANE.drum_torque(55e3)


@pytest.mark.parametrize("source", ["reference", "measured"])
def test_a_target_without_its_inputs_turns_with_its_own_speed_and_grows_little_from_rest(source):
    """At a hundredth of the direction a target says next to nothing of the size: it would be a hundred times it."""
    each = compensator(velocity_source=source, scale=1.0, reversal_time=0.0)
    whole = model_torque(SEED, ahc_sample(0.0, 100.0), 100.0)
    for start, most in ((100.0, whole), (0.03, 0.2 * whole)):
        each.reset()
        each.step(ahc_sample(0.0, start))
        each._target.reversal = 0.5  # s, as of before
        lost = replace(ahc_sample(PERIOD, -100.0), groups={}, motor_speed=30.0, speed_reference=30.0)
        own = "speed_reference" if source == "reference" else "motor_speed"
        each.step(replace(lost, **{own: -100.0}))
        assert -most * (1.0 + 1e-9) <= each._target.torque < 0.0
        assert each._target.reversal == math.inf
    each.step(replace(lost, time=2 * PERIOD, **{own: 1e6}))  # no speed of this crane
    assert each._target.torque < 0.0


def test_a_target_without_its_inputs_stays_inside_the_envelope_of_the_seed():
    each = compensator(scale=1.0, envelope=0.4)
    each.step(ahc_sample(0.0, 0.5))
    envelope = each._target.envelope
    each._target.size = 10.0 * envelope
    each.step(replace(ahc_sample(PERIOD, 100.0), groups={}))
    assert each._target.torque == pytest.approx(envelope)


def test_a_load_from_the_balance_takes_off_what_accelerates_the_shaft():
    each, acceleration = compensator(load_filter=0.1, scale=1.0, acceleration_filter=0.0, jerk_filter=0.0), 60.0
    for k in range(100):
        speed = 50.0 + acceleration * k * PERIOD
        held = CRANE.drum_torque(40e3) / CRANE.gear_ratio + CRANE.inertia * acceleration
        held += each._law.torque(_point_of(each, k, speed), 1) if k else 0.0
        motors = CRANE.motor_count("active") * CRANE.max_displacement
        group = GroupSample(held / motors + 25 * BAR, 25 * BAR, CRANE.max_displacement)
        each.step(Sample(k * PERIOD, speed, speed_reference=speed, groups={"active": group}))
    assert each.status()["drum_torque"] == pytest.approx(CRANE.drum_torque(40e3), rel=0.02)


def _point_of(each, k, speed):
    group = GroupSample(300 * BAR, 25 * BAR, CRANE.max_displacement)
    sample = Sample(k * PERIOD, speed, groups={"active": group})
    return sample_operating_point(sample, CRANE, drum_torque=CRANE.drum_torque(40e3), speed=speed)


@pytest.mark.parametrize("speed", [1.0, 20.0, 400.0])
def test_a_slew_is_what_a_reversal_of_the_friction_at_this_load_needs_however_fast_it_turns(speed):
    """A loss that is there near standstill alone must not hold up the next reversal; one that grows must not either."""
    for name in ("stribeck", "viscous"):
        seed = SEED.subset([name])
        config = CompensatorConfig(reversal_time=0.5, reversal_speed=3.0, envelope=1.3)
        each = FeedforwardCompensator(CRANE, seed, config)
        each.step(ahc_sample(0.0, speed))
        sizes = [abs(model_torque(seed, ahc_sample(0.0, 55.0), at)) for at in (3.0, speed)]
        assert each.status()["slew_limit"] == pytest.approx(1.3 * max(sizes) / 0.5)


def test_of_two_models_before_a_sample_the_difference_to_what_was_published_is_carried_over():
    """The one between them was never published: with it as the one before, the second made a step."""
    each = compensator(ramp_time=1.0)
    _, time = run_up(each, until=2.0)
    before = each.step(ahc_sample(time, 100.0)).friction_torque
    for factor in (1.3, 1.2):
        each.load_model(SEED.with_values({"C6": SEED.value("C6") * factor}))
    found = each.step(ahc_sample(time + PERIOD, 100.0)).friction_torque
    target = 0.9 * model_torque(each.model, ahc_sample(0.0, 100.0), 100.0)
    assert target > before + 10.0
    assert found == pytest.approx(before + PERIOD * (target - before), abs=0.01 * (target - before))


def test_a_load_that_is_set_while_it_runs_is_the_load():
    each, other = compensator(load=20e3), compensator(load=80e3)
    each.step(ahc_sample(0.0, 100.0, hook_load=math.nan))
    each.configure(CompensatorConfig(load=80e3))
    for k in range(1, 3):
        one, two = (law.step(ahc_sample(k * PERIOD, 100.0, hook_load=math.nan)) for law in (each, other))
        assert one.drum_torque == two.drum_torque == CRANE.drum_torque(80e3, math.nan)


def test_a_command_in_rpm_gives_the_bound_no_room_beyond_the_fastest_speed():
    """The envelope is what the largest speed of the crane, or twice the measured one, asks for, whatever comes in."""
    each, fastest = compensator(scale=1.3, envelope=1.0), ChannelRanges(CRANE).speed
    run_up(each, speed=100.0)
    each.step(replace(ahc_sample(1.0, 100.0), speed_reference=0.95 * fastest))
    bound = fastest_command(100.0, fastest)
    assert bound < 0.9 * fastest
    assert each._target.envelope == pytest.approx(
        min(model_torque(SEED, ahc_sample(0.0, speed), speed) for speed in (bound, 0.95 * fastest)), rel=1e-9
    )


def test_it_is_called_active_only_once_it_has_faded_in_wholly():
    outputs, _ = run_up(compensator(ramp_time=0.2))
    assert {each.state for each in outputs if each.fade < 1.0} == {"fading"}
    assert {each.state for each in outputs if each.fade == 1.0} == {"active"}
    assert sum(0.5 < each.fade < 1.0 for each in outputs) >= 3


def test_a_sample_without_a_time_counts_as_stale_and_changes_nothing():
    each = compensator()
    outputs, time = run_up(each)
    found = each.step(ahc_sample(math.nan, 100.0))
    assert found is outputs[-1]
    status = each.status()
    assert (status["steps"], status["stale"], status["missing"]) == (len(outputs) + 1, 1, "time")
    assert each.step(ahc_sample(time, 100.0)).valid
    fresh = compensator().step(ahc_sample(math.inf, 100.0))
    assert (fresh.friction_torque, fresh.state, fresh.valid) == (0.0, "waiting", False)


def test_a_term_with_a_memory_moves_with_the_samples():
    """Presliding: after a reversal the bristles turn over a few hundredths of a radian, not at once and not never."""
    term = term_named("presliding")
    model = FrictionModel("bristles", (term,), tuple(each.typical for each in term.parameters))
    each = FeedforwardCompensator(CRANE, model, CompensatorConfig(scale=1.0, ramp_time=0.02))
    law = FrictionLaw(model, {})
    for k in range(20):
        sample = ahc_sample(k * PERIOD, 20.0)
        each.step(sample)
        drum_torque = CRANE.drum_torque(55e3, math.nan)
        point = sample_operating_point(sample, CRANE, drum_torque=drum_torque, speed=20.0, width=3.0)
        law.advance(point, 2, PERIOD if k else 0.0)
    assert each._law._states == pytest.approx(law._states)
    assert each._law._states[0] != FrictionLaw(model, {})._functions(2).initial_states[0]


def test_a_model_that_reads_no_load_asks_for_none_and_says_none():
    each = FeedforwardCompensator(CRANE, SEED.subset(["viscous"]), CompensatorConfig(ramp_time=0.2))
    out = each.step(ahc_sample(0.0, 100.0))
    assert (out.drum_torque, each.status()["drum_torque"]) == (0.0, 0.0)
    assert compensator().step(ahc_sample(0.0, 100.0)).drum_torque == CRANE.drum_torque(55e3, math.nan)


@pytest.mark.parametrize("lead", [0.0, 0.2])
def test_a_torque_that_looks_ahead_may_push_against_the_measured_motion_for_as_much_longer(lead):
    """The command is ahead of the winch by the look-ahead; what lasts longer than that and a lag is let go."""
    each = compensator(lead=lead)
    _, began = run_up(each)
    turned = began + PERIOD * np.arange(40)
    outs = [each.step(replace(ahc_sample(t, 100.0), motor_speed=-100.0)) for t in turned]
    held = next(t for t, out in zip(turned, outs, strict=True) if out.friction_torque == 0.0) - began
    assert held == pytest.approx(lead + LONGEST_LAG + LONGEST_AGAINST, abs=2.5 * PERIOD)


def test_after_a_reset_nothing_of_what_was_before_is_known():
    """100 rad/s^2 with a lead of 0.1 s: 10 rad/s ahead of what is measured, and none once that was forgotten."""
    each = compensator(lead=0.1)
    for time in np.arange(0.0, 1.0, PERIOD):
        out = each.step(ahc_sample(time, 100.0 * time))
    assert out.speed == pytest.approx(100.0 * time + 10.0, abs=0.5)
    assert (each.status()["state"], each.status()["drum_torque"]) == ("active", CRANE.drum_torque(55e3))
    each.reset()
    assert (each.status()["state"], each.status()["drum_torque"]) == ("waiting", 0.0)
    assert each.step(ahc_sample(1.0, 100.0)).speed == 100.0


@pytest.mark.parametrize("bound", [math.inf, math.nan])
def test_a_seed_that_bounds_nothing_is_no_model(bound, monkeypatch):
    """A torque is a number, and what it may be at most is none: what was published ends."""
    each = compensator()
    outputs, time = run_up(each)
    monkeypatch.setattr(each._seed_law, "magnitude", lambda *point: bound)
    assert each.step(ahc_sample(time, 100.0)).valid is False
    assert each.lost == ("finite model",)
