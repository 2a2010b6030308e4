"""Corrections: every one declared is visited, and what it says is wrong is taken out of runs, samples and cranes."""

import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from scipy.signal import lsim

from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY
from winch_friction.physics.corrections import corrected, corrected_crane, lateness, unswung
from winch_friction.physics.errors import InputError
from winch_friction.physics.fluid import relative_viscosity, relaxed_compression
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import DECLARED, Action
from winch_friction.physics.sample_corrections import SampleCorrector, past_corrections
from winch_friction.physics.signals import GroupSample, Run, Sample
from winch_friction.physics.winch import Drum
from winch_friction.records.model_file import model_from_text, model_to_text

GROUPS = ("active", "passive")


@pytest.fixture
def truth():
    """A minute of heave at 50 Hz with every channel, nothing wrong with it."""
    time = np.arange(0.0, 60.0, 0.02)
    wave = np.sin(2.0 * np.pi * time / 10.0)
    columns = {
        "time": time + 1.7e9,
        "motor_speed": 180.0 * wave,
        "speed_reference": 181.0 * wave,
        "shaft_angle": -280.0 * np.cos(2.0 * np.pi * time / 10.0),
        "hook_load": np.full(len(time), 55e3),
        "oil_temperature": 30.0 + 0.2 * time,
        "wire_layer": np.full(len(time), 6.0),
        "wire_out": 100.0 - 3.0 * wave,
        "motor_torque": 50.0 * wave,
    }
    for k, group in enumerate(GROUPS):
        columns[f"{group}.pressure_a"] = (220.0 + 40.0 * wave + 20.0 * k) * BAR
        columns[f"{group}.pressure_b"] = (25.0 + 2.0 * wave) * BAR
        columns[f"{group}.displacement"] = np.full(len(time), 150.0 * CM3_PER_REV)
    return Run("truth", columns)


DRAWN = ((2.0, 0.25), (20.0, 1.0), (45.0, 0.5))  # s since the run began, share
BENDS_AT = {"Pa": 210.0 * BAR, "m^3/rad": 140.0 * CM3_PER_REV}


def ties(name):
    """What a correction of that name has to be given beside its value."""
    own = DECLARED[name]
    more = {"groups": ("active",)} if own.by_group else {}
    more |= {"during": ((-20.0, 30.0),)} if own.grows else {}
    more |= {"beyond": BENDS_AT[own.bends_in]} if own.bends_in else {}
    more |= {"beyond": 215.0 * CM3_PER_REV} if own.action is Action.S_SHAPE else {}
    more |= {"course": DRAWN} if own.course == "drawn" else {}
    return more | ({"time_constant": 60.0} if own.has_time_constant else {})


def typical(name, sign=1.0):
    lower = DECLARED[name].parameter.lower
    return Correction(name, (sign if lower < 0.0 else 1.0) * DECLARED[name].parameter.typical, **ties(name))


def fullness(correction, time):
    """What a delay is of its value, `time` s from the run's beginning."""
    of, over = correction.name.rpartition("_")[2], correction.time_constant
    return {
        "delay": lambda: np.ones_like(time), "clock": lambda: time, "backlog": lambda: np.exp(-time / over),
        "buffer": lambda: time / over - np.floor(time / over),
        "course": lambda: np.interp(time, [2.0, 20.0, 45.0], [0.25, 1.0, 0.5]),
    }[of]()  # fmt: skip


def spoiled(run, correction):
    """The run as a machine with this error logs it: written here on its own, from the words of the declarations."""
    e, action, columns = correction.value, correction.declared.action, dict(run.columns)
    time = run.time - run.time[0]
    for channel in correction.declared.channels:
        names = [name for name in (channel, f"active.{channel}") if name in columns]
        if correction.declared.late:
            names = [name for name in columns if name.rpartition(".")[2] == channel]
        for name in names:
            true = columns[name]
            if action is Action.OFFSET:
                warmer = columns["oil_temperature"] - 40.0 if correction.declared.reads else 1.0
                square = correction.name == "pressure_thermal_bow"
                columns[name] = true + e * (warmer * warmer if square else warmer)
                if correction.declared.grows:
                    ((begin, end),) = correction.during
                    columns[name] = true + e * np.interp(run.time, [begin, end], [0.0, 1.0])
            elif action is Action.SCALE:
                warmer = columns["oil_temperature"] - 40.0 if correction.declared.reads else 1.0
                columns[name] = true * (1.0 + e * warmer)
            elif action is Action.CURVATURE:
                columns[name] = true * (1.0 + e * true)
            elif action is Action.BEND:
                columns[name] = np.where(true > correction.beyond, true + e * (true - correction.beyond), true)
            elif action is Action.S_SHAPE:
                x = true / correction.beyond
                columns[name] = true + e * 6.0 * np.sqrt(3.0) * x * (1.0 - x) * (1.0 - 2.0 * x)
            elif action is Action.DELAY:
                columns[name] = np.interp(time - e * fullness(correction, time), time, true)
            elif action is Action.FILTER:  # settled on the first value
                columns[name] = true[0] + lsim(([1.0], [e, 1.0]), true - true[0], 0.02 * np.arange(len(time)))[1]
            elif action is Action.MASS:
                columns[name] = true - e * (columns["wire_out"] if correction.declared.reads else 1.0)
            elif action is Action.WARMTH:
                columns[name] = true / (1.0 + e * np.exp(-time / correction.time_constant))
            elif action is Action.HEAT:
                calculated = true.copy()
                for _ in range(40):  # the calculated pressure stands on both sides
                    calculated = true / (1.0 - e * relaxed_compression(time, calculated, correction.time_constant))
                columns[name] = calculated
            elif action is Action.SLIP:
                drop = columns["active.pressure_a"] - columns["active.pressure_b"]
                thin = 1.0 / relative_viscosity(columns["oil_temperature"])
                flow = {
                    "slip_leakage": drop * thin,
                    "orifice_leakage": np.sign(drop) * np.sqrt(np.abs(drop) * 150 * BAR),
                    "isoviscous_leakage": drop,
                    "opening_gap_leakage": drop * np.abs(drop) / (150 * BAR) * thin,
                }[correction.name]
                columns[name] = true + e * flow / columns["active.displacement"]
            elif action is Action.AIR:  # the compliance of the air, V/1.4 (p_0/p)^(1/1.4)/p, times the pressure's rate
                high = columns["active.pressure_a"]
                softness = e / 1.4 * (BAR / high) ** (1.0 / 1.4) / high
                swept = 3 * columns["active.displacement"]  # of three motors, crane_150t
                columns[name] = true + softness * np.gradient(high, time) / swept
    return replace(run, columns=columns)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("name", DECLARED)
def test_every_correction_gives_the_truth_back(name, sign, truth, crane_150t, crane2_model):
    correction = typical(name, sign)
    logged = spoiled(truth, correction)
    changed = [c for c in truth.columns if not np.array_equal(logged[c], truth[c])]
    model = replace(crane2_model, corrections=(correction,))
    run, crane = corrected(logged, crane_150t, model)
    if correction.declared.kind in ("geometry", "inertia"):
        assert crane != crane_150t
        assert not changed
    else:
        assert changed, "the error must show in the log, or this test proves nothing"
        assert crane is crane_150t
    keep = np.isin(truth.time, run.time)
    # a delay and a filter do not know what came before the log began, and a delay loses what it shifts at one end
    inner = slice(60, -60) if correction.declared.late else slice(None)
    known = np.ones(len(run), bool)
    if name.endswith("_buffer"):  # what went by while it was emptied, and the first sample of it, was never logged
        since = run.time - run.time[0]
        known = fullness(correction, since) < 1.0 - (correction.value + 0.04) / correction.time_constant
        assert 0.9 < known.mean() < 1.0
    for column in truth.columns:
        np.testing.assert_allclose(run[column][known][inner], truth[column][keep][known][inner], rtol=1e-3, atol=1e-2)
    assert run.metadata["corrections"] == (name,)


@pytest.mark.parametrize("name", DECLARED)
def test_a_sample_that_is_lost_spoils_its_neighbours_alone(name, truth, crane_150t, crane2_model):
    correction = typical(name)
    model, logged = replace(crane2_model, corrections=(correction,)), spoiled(truth, correction)
    lossy = {column: values.copy() for column, values in logged.columns.items()}
    for column, values in lossy.items():
        if column != "time":
            values[500:503] = np.nan
    whole, holed = (corrected(run, crane_150t, model)[0] for run in (logged, replace(logged, columns=lossy)))
    far = np.ones(len(whole), bool)
    far[490:515] = False
    for column in whole.columns:
        np.testing.assert_allclose(holed[column][far], whole[column][far], rtol=1e-5, atol=1e-6, err_msg=column)


def test_a_delay_of_whole_samples_is_exact(truth, crane_150t, crane2_model):
    correction = Correction("signal_delay", 0.1)
    model = replace(crane2_model, corrections=(correction,))
    run, _ = corrected(spoiled(truth, correction), crane_150t, model)
    assert len(run) == len(truth) - 5
    np.testing.assert_allclose(run["motor_speed"], truth["motor_speed"][:-5], atol=1e-4)
    np.testing.assert_array_equal(run["active.pressure_a"], truth["active.pressure_a"][:-5])


def test_what_a_full_buffer_swallows_is_a_line_between_its_neighbours(truth, crane_150t, crane2_model):
    """Late by 0.2 s when full, every 5 s: between 4.8 and 5 s a straight line, after it the log as it is again."""
    model = replace(crane2_model, corrections=(Correction("signal_buffer", 0.2, time_constant=5.0),))
    ramp = np.arange(len(truth)) * 1.0
    run, _ = corrected(replace(truth, columns=truth.columns | {"motor_speed": ramp}), crane_150t, model)
    since = run.time - run.time[0]
    beginning, swallowed, after = (since < 4.78), (since > 4.82) & (since < 4.98), (since > 5.02) & (since < 9.78)
    for part, begins in ((beginning, 0.0), (after, 5.0)):
        logged = begins + (since[part] - begins) / 0.96  # logged when it was full by so much
        np.testing.assert_allclose(run["motor_speed"][part] * 0.02, logged, atol=1e-6)  # stamps since 1970
    np.testing.assert_allclose(np.diff(run["motor_speed"][swallowed], 2), 0.0, atol=1e-4)
    assert len(truth) - len(run) in (0, 1, 10)


@pytest.mark.parametrize(("upper", "period", "allowed"), [(0.5, 0.6, True), (0.5, 0.5, False), (0.1, 0.2, True)])
def test_a_buffer_holds_less_than_what_fills_it(upper, period, allowed):
    def asked():
        return Correction("pressure_buffer", 0.05, upper=upper, time_constant=period)

    if allowed:
        assert asked().time_constant == period
    else:
        with pytest.raises(InputError, match="'pressure_buffer': time_constant must be above its bounds"):
            asked()


def test_offset_and_gain_of_one_transducer_come_out_together(truth, crane_150t, crane2_model):
    gain, offset = Correction("pressure_scale", 0.05), Correction("pressure_offset", 2 * BAR)
    logged = spoiled(spoiled(spoiled(truth, replace(gain, groups=("active",))), offset), Correction("tare_load", 1e3))
    offset, gain = replace(offset, groups=("active",)), replace(gain, groups=("active",))
    for order in ((offset, gain), (gain, offset)):
        model = replace(crane2_model, corrections=(*order, Correction("tare_load", 1e3)))
        run, _ = corrected(logged, crane_150t, model)
        np.testing.assert_allclose(run["active.pressure_a"], truth["active.pressure_a"], rtol=1e-12)
        np.testing.assert_allclose(run["hook_load"], truth["hook_load"], rtol=1e-12)


def test_only_the_named_groups_are_touched(truth, crane_150t, crane2_model):
    model = replace(crane2_model, corrections=(Correction("pressure_offset", BAR, groups=("passive",)),))
    run, _ = corrected(truth, crane_150t, model)
    np.testing.assert_array_equal(run["active.pressure_a"], truth["active.pressure_a"])
    np.testing.assert_allclose(run["passive.pressure_a"], truth["passive.pressure_a"] - BAR)


def test_a_group_that_is_not_there_is_told_with_model_and_correction(crane_150t):
    """Of five models and a crane it was said what the crane has, and not whose correction asked for another one."""
    wrong = Correction("pressure_offset", BAR, groups=("active", "port"))
    with pytest.raises(InputError, match="^model 'mine': correction 'pressure_offset': crane 'crane_150t' has no mot"):
        corrected_crane(crane_150t, (wrong,), "mine")
    with pytest.raises(InputError, match="^correction 'pressure_offset': .* 'port'; it has main, active, passive$"):
        corrected_crane(crane_150t, (wrong,))
    with pytest.raises(InputError, match="^model 'mine': correction 'layer_radius': .* has no wire layer 9$"):
        corrected_crane(crane_150t, (Correction("layer_radius", 0.01, layers=(9,)),), "mine")


def test_layers_and_inertia_go_into_the_crane(crane_150t):
    old = crane_150t.drum.layer_radii
    found = corrected_crane(
        crane_150t, (Correction("layer_radius", 0.01), Correction("layer_radius", -0.05, layers=(3,)))
    )
    assert found.drum.layer_radii == pytest.approx([r + 0.01 - (0.05 if k == 2 else 0.0) for k, r in enumerate(old)])
    assert corrected_crane(crane_150t, (Correction("inertia", 0.2),)).inertia == pytest.approx(1.74)


@pytest.mark.parametrize("name", [n for n, d in DECLARED.items() if d.live])
def test_a_sample_is_corrected_like_its_run(name, truth, crane_150t, crane2_model):
    model = replace(crane2_model, corrections=(typical(name),))
    logged = spoiled(truth, typical(name))
    run, crane = corrected(logged, crane_150t, model)
    corrector = SampleCorrector(crane_150t, model)
    assert corrector.crane == crane
    for given, right in zip(list(logged.samples())[::200], list(run.samples())[::200], strict=True):
        before = repr(given)
        assert corrector(given) == right
        assert repr(given) == before
        assert corrector.uncorrected == ()


@pytest.mark.parametrize("name", [n for n, d in DECLARED.items() if not d.live])
def test_a_running_node_refuses_by_name_what_it_cannot_take_out(name, truth, crane_150t, crane2_model):
    model = replace(crane2_model, corrections=(typical(name), Correction("pressure_offset", BAR)))
    with pytest.raises(InputError, match=name):
        SampleCorrector(crane_150t, model)
    corrector = SampleCorrector(crane_150t, model, refuse=False)
    assert corrector.uncorrected == (name,)
    sample = next(iter(truth.samples()))
    assert corrector(sample).groups["active"].pressure_a == sample.groups["active"].pressure_a - BAR


def test_a_sample_without_the_wire_keeps_its_load_and_says_so(truth, crane_150t, crane2_model):
    corrector = SampleCorrector(crane_150t, replace(crane2_model, corrections=(typical("wire_weight"),)))
    sample = replace(next(iter(truth.samples())), wire_out=float("nan"))
    assert corrector(sample).hook_load == sample.hook_load
    assert corrector.uncorrected == ("wire_weight",)
    assert corrector(next(iter(truth.samples()))).hook_load == pytest.approx(55e3 + 12.0 * 100.0)
    assert corrector.uncorrected == ()


def test_a_sample_without_the_oil_keeps_its_pressure_and_says_so(truth, crane_150t, crane2_model):
    model = replace(crane2_model, corrections=(Correction("pressure_thermal_zero", 0.2 * BAR),))
    corrector = SampleCorrector(crane_150t, model)
    warm = replace(next(iter(truth.samples())), oil_temperature=55.0)
    pressure = warm.groups["active"].pressure_a
    assert corrector(warm).groups["active"].pressure_a == pytest.approx(pressure - 3.0 * BAR)
    cold = replace(warm, oil_temperature=float("nan"))
    assert corrector(cold).groups["active"].pressure_a == pressure
    assert corrector.uncorrected == ("pressure_thermal_zero",)


def test_a_zero_creeps_within_its_time_and_stays(truth, crane_150t, crane2_model):
    creeping = Correction("pressure_creep", 4.0 * BAR, during=((100.0, 200.0),))
    corrector = SampleCorrector(crane_150t, replace(crane2_model, corrections=(creeping,)))
    sample = next(iter(truth.samples()))
    logged = sample.groups["active"].pressure_a
    for time, error in ((50.0, 0.0), (100.0, 0.0), (150.0, 2.0 * BAR), (200.0, 4.0 * BAR), (9e9, 4.0 * BAR)):
        right = corrector(replace(sample, time=time)).groups["active"].pressure_a
        assert right == pytest.approx(logged - error, abs=1e-6)
    assert corrector.uncorrected == ()


def test_a_load_gathers_within_its_time_and_stays(truth, crane_150t, crane2_model):
    gathering = Correction("tare_creep", 800.0, during=((100.0, 200.0),))
    model = replace(crane2_model, corrections=(gathering,))
    corrector, sample = SampleCorrector(crane_150t, model), next(iter(truth.samples()))
    for time, more in ((50.0, 0.0), (150.0, 400.0), (9e9, 800.0)):
        assert corrector(replace(sample, time=time)).hook_load == pytest.approx(sample.hook_load + more)
        shifted = replace(truth, columns={**truth.columns, "time": truth.time - truth.time[0] + time})
        right, _ = corrected(shifted, crane_150t, model)
        grown = 800.0 * np.clip((shifted.columns["time"] - 100.0) / 100.0, 0.0, 1.0)
        np.testing.assert_allclose(right.columns["hook_load"], truth.columns["hook_load"] + grown)


@pytest.mark.parametrize("during", [(), ((0.0, 1.0), (2.0, 3.0)), ((0.0, float("inf")),)])
def test_a_creeping_zero_needs_one_window_that_ends(during):
    with pytest.raises(InputError, match="pressure_creep' needs during: one window"):
        Correction("pressure_creep", 4.0 * BAR, during=during)


def test_without_corrections_nothing_is_touched(truth, crane_150t, crane2_model):
    assert corrected(truth, crane_150t, crane2_model) == (truth, crane_150t)
    sample = next(iter(truth.samples()))
    assert SampleCorrector(crane_150t, crane2_model)(sample) is sample


@pytest.mark.parametrize("name", [n for n, d in DECLARED.items() if d.channels and not d.late])
def test_a_missing_channel_is_one_line_by_name(name, truth, crane_150t, crane2_model):
    own = DECLARED[name]
    for channel in (*own.channels, *own.reads):
        column = channel if channel in truth else f"active.{channel}"
        run = replace(truth, columns={k: v for k, v in truth.columns.items() if k != column})
        with pytest.raises(InputError) as error:
            corrected(run, crane_150t, replace(crane2_model, corrections=(typical(name),)))
        assert column in str(error.value)
        assert name in str(error.value)
        assert "\n" not in str(error.value)


def test_a_group_that_does_not_run_needs_no_correction(truth, crane_150t, crane2_model):
    alone = replace(truth, columns={k: v for k, v in truth.columns.items() if not k.startswith("passive.")})
    model = replace(crane2_model, corrections=(Correction("pressure_offset", BAR, groups=("passive",)),))
    run, _ = corrected(alone, crane_150t, model)
    np.testing.assert_array_equal(run["active.pressure_a"], alone["active.pressure_a"])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "rope_weight", "value": 1.0}, "not known; known corrections are pressure_offset"),
        ({"name": "wire_weight", "value": -18.9}, "-18.9 kg/m is outside 0"),
        ({"name": "wire_weight", "value": 1.0, "lower": -5.0}, "bounds -5 .* must lie inside 0"),
        ({"name": "tare_load", "value": float("nan")}, "nan kg is outside"),
        ({"name": "tare_load", "value": 1.0, "std": float("nan")}, "std must be a finite number"),
        ({"name": "tare_load", "value": 1.0, "groups": ("active",)}, "cannot be tied to motor groups"),
        ({"name": "pressure_offset", "value": 1.0, "layers": (1,)}, "cannot be tied to wire layers"),
        ({"name": "accumulator_warmth", "value": 0.01}, "needs a time_constant"),
        ({"name": "inertia", "value": 0.1, "time_constant": 3.0}, "has no time_constant"),
    ],
)
def test_what_is_not_physical_is_refused(arguments, message):
    with pytest.raises(InputError, match=message):
        Correction(**arguments)


def test_the_same_correction_twice_is_refused(crane2_model):
    twice = (Correction("tare_load", 1.0), Correction("tare_load", 2.0))
    with pytest.raises(InputError, match="tare_load.*twice"):
        replace(crane2_model, corrections=twice)


@pytest.mark.parametrize(
    ("corrections", "message"),
    [
        ((Correction("pressure_offset", 1.0, groups=("activ",)),), "no motor group 'activ'"),
        ((Correction("layer_radius", 0.01, layers=(7,)),), "no wire layer 7"),
        ((Correction("inertia", -1.6),), "at or below zero"),
    ],
)
def test_a_correction_that_the_crane_cannot_have_is_refused(corrections, message, truth, crane_150t, crane2_model):
    with pytest.raises(InputError, match=message):
        corrected(truth, crane_150t, replace(crane2_model, corrections=corrections))
    with pytest.raises(InputError, match=message):
        SampleCorrector(crane_150t, replace(crane2_model, corrections=corrections))


def test_a_drum_of_one_layer_keeps_its_type(crane_150t):
    assert isinstance(corrected_crane(crane_150t, (Correction("layer_radius", 0.1),)).drum, Drum)


def test_an_error_for_a_time_is_taken_out_then_and_only_then(truth, crane_150t, crane2_model):
    """A transducer that was replaced, a hook that was exchanged: the runs and samples of the time alone change."""
    begin = float(truth.time[0])
    for windows, there in (
        (((begin - 9.0, begin + 90.0),), True),
        (((begin - 90.0, begin - 9.0),), False),
        (((begin - 90.0, begin - 80.0), (begin - 9.0, float("inf"))), True),
    ):
        offset = Correction("pressure_offset", 2.0 * BAR, during=windows)
        tare = Correction("tare_load", 1500.0, during=windows)
        model = replace(crane2_model, corrections=(offset, tare))
        right, _ = corrected(truth, crane_150t, model)
        assert np.allclose(truth["active.pressure_a"] - right["active.pressure_a"], 2.0 * BAR * there)
        assert np.allclose(right["hook_load"] - truth["hook_load"], 1500.0 * there)
        sample = next(iter(truth.samples()))
        live = SampleCorrector(crane_150t, model)(sample)
        assert live.hook_load - sample.hook_load == pytest.approx(1500.0 * there)
        assert model_from_text(model_to_text(model), "m").corrections == model.corrections
    with pytest.raises(InputError, match="cannot be tied to a time"):
        Correction("inertia", 0.1, during=((0.0, 1.0),))
    with pytest.raises(InputError, match="from before to"):
        Correction("pressure_offset", 0.1, during=((1.0, 0.0),))


def told_by(truth, *names):
    """The run, with what tells the load in its place."""
    columns = {k: v for k, v in truth.columns.items() if k != "hook_load"}
    told = {"rope_force": 5.5e5, "load_torque": 2.4e3, "hook_load": 55e3}
    return Run("told", columns | {name: np.full(len(truth.time), told[name]) for name in names})


@pytest.mark.parametrize("name", ["tare_load", "wire_weight"])
def test_a_mass_is_missing_in_whatever_tells_the_load(name, truth, crane_150t, crane2_model):
    """A rope's force that crept ended the whole search: "column 'hook_load' is missing"."""
    model = replace(crane2_model, corrections=(Correction(name, 50.0),))
    mass = 50.0 * (truth["wire_out"] if name == "wire_weight" else 1.0)
    at_shaft = GRAVITY * mass * crane_150t.drum.radius(6.0) / crane_150t.gear_ratio
    for names, added in (
        (("rope_force",), {"rope_force": GRAVITY * mass}),
        (("load_torque",), {"load_torque": at_shaft}),
        (("hook_load", "rope_force"), {"hook_load": mass, "rope_force": 0.0}),
        (("hook_load", "load_torque"), {"hook_load": mass, "load_torque": at_shaft}),
    ):
        run = told_by(truth, *names)
        right, _ = corrected(run, crane_150t, model)
        for column, more in added.items():
            np.testing.assert_allclose(right[column] - run[column], more, rtol=1e-9)
    run = told_by(truth, "load_torque")
    outer = Run("outer", {k: v for k, v in run.columns.items() if k != "wire_layer"})
    np.testing.assert_allclose(corrected(outer, crane_150t, model)[0]["load_torque"] - 2.4e3, at_shaft)
    with pytest.raises(InputError, match=f"'hook_load' is missing; correction {name} needs it"):
        corrected(told_by(truth), crane_150t, model)


def test_a_mass_acts_on_the_layer_that_was_said_last(truth, crane_150t, crane2_model):
    """A layer that is said now and then holds in between, as it does for every other lever of the run."""
    run, model = told_by(truth, "load_torque"), replace(crane2_model, corrections=(Correction("tare_load", 50.0),))
    said = np.full(len(run.time), np.nan)
    said[0] = 2.0
    now_and_then = Run("now and then", {**run.columns, "wire_layer": said})
    at_shaft = GRAVITY * 50.0 * crane_150t.drum.radius(2.0) / crane_150t.gear_ratio
    np.testing.assert_allclose(corrected(now_and_then, crane_150t, model)[0]["load_torque"] - 2.4e3, at_shaft)


def test_a_running_node_puts_the_mass_into_the_ropes_force_where_no_cell_weighs(truth, crane_150t, crane2_model):
    model = replace(crane2_model, corrections=(Correction("tare_load", 50.0), Correction("wire_weight", 2.0)))
    corrector, sample = SampleCorrector(crane_150t, model), next(iter(told_by(truth, "rope_force").samples()))
    mass = 50.0 + 2.0 * sample.wire_out
    assert corrector(sample).rope_force - 5.5e5 == pytest.approx(GRAVITY * mass)
    assert corrector(replace(sample, wire_out=float("nan"))).rope_force - 5.5e5 == pytest.approx(GRAVITY * 50.0)
    assert corrector.uncorrected == ("wire_weight",)
    both = corrector(replace(sample, hook_load=55e3))
    assert (both.hook_load - 55e3, both.rope_force) == (pytest.approx(mass), 5.5e5)
    silent = corrector(replace(sample, wire_out=float("nan")))  # the cell, which was there before
    assert silent.rope_force == 5.5e5
    assert corrector.uncorrected == ()


def test_a_file_with_a_window_that_is_none_says_so(crane2_model):
    text = model_to_text(replace(crane2_model, corrections=(Correction("pressure_offset", 1e5, during=((1.0, 2.0),)),)))
    content = yaml.safe_load(text)
    content["corrections"]["pressure_offset"]["during"] = [1.0, 2.0]
    with pytest.raises(InputError, match="during must be a list of windows"):
        model_from_text(yaml.safe_dump(content), "m")


def test_what_a_running_node_cannot_take_out_is_accepted_once_it_is_over(truth, crane_150t, crane2_model):
    """A delay that was mended: no sample from now on has it. One that is there, or will be, is refused."""
    now = 1000.0
    for windows, over in (
        (((0.0, 999.0),), True),
        (((0.0, 10.0), (500.0, 999.0)), True),
        (((0.0, 10.0), (999.0, 1001.0)), False),
        (((0.0, 1000.0),), False),
        (((0.0, float("inf")),), False),
        (((2000.0, 3000.0),), False),
        ((), False),
    ):
        model = replace(crane2_model, corrections=(Correction("signal_delay", 0.05, during=windows),))
        with pytest.raises(InputError, match="signal_delay"):
            SampleCorrector(crane_150t, model)
        if over:
            corrector = SampleCorrector(crane_150t, model, since=now)
            assert corrector.impossible == ()
            assert corrector.past == {"signal_delay": 999.0}
            assert corrector.standing(now) == ()
            assert corrector.standing(5.0) == ("signal_delay",)
            apart = tuple(Correction("signal_delay", 0.05, during=(each,)) for each in windows)
            assert SampleCorrector(crane_150t, replace(model, corrections=apart), since=now).past == corrector.past
        else:
            with pytest.raises(InputError, match="signal_delay"):
                SampleCorrector(crane_150t, model, since=now)


def test_a_filter_is_behind_what_bends_a_signal(truth, crane_150t, crane2_model):
    """A transducer bends, and what it says is filtered: the filter comes out first."""
    bend, late = Correction("pressure_curvature", 1e-9), Correction("pressure_filter", 0.3)
    logged = truth
    for each in (bend, late):
        logged = spoiled(logged, each)
    run, _ = corrected(logged, crane_150t, replace(crane2_model, corrections=(bend, late)))
    off = np.abs(run["active.pressure_a"] - truth["active.pressure_a"])[100:-100]
    assert off.max() < 100.0  # Pa; straightened before the filter is out it is off by 570


def test_several_bends_are_taken_out_in_turn(truth, crane_150t, crane2_model):
    """Each is put on what those nearer to zero have made of the signal, whatever their order in the file."""
    bends = [(180.0 * BAR, 0.04), (215.0 * BAR, -0.06), (235.0 * BAR, 0.05)]
    logged = truth["active.pressure_a"].copy()
    for beyond, e in bends:
        logged = logged + e * np.maximum(logged - beyond, 0.0)
    corrections = tuple(
        Correction("pressure_bend", e, groups=("active",), beyond=beyond)
        for beyond, e in (bends[1], bends[0], bends[2])
    )
    model = replace(crane2_model, corrections=corrections)
    log = replace(truth, columns={**truth.columns, "active.pressure_a": logged})
    right, _ = corrected(log, crane_150t, model)
    assert np.abs(right["active.pressure_a"] - truth["active.pressure_a"]).max() < 1e-3
    member = GroupSample(float(logged[70]), 25.0 * BAR, 150.0 * CM3_PER_REV)
    live = SampleCorrector(crane_150t, model)(Sample(0.0, 1.0, groups={"active": member}))
    assert live.groups["active"].pressure_a == pytest.approx(truth["active.pressure_a"][70], abs=1e-3)


@pytest.mark.parametrize(
    ("name", "beyond", "says"),
    [
        ("pressure_bend", None, "needs beyond, in Pa"),
        ("displacement_bend", -1.0, "beyond must be above 0 m"),
        ("pressure_scale", 1e7, "has no beyond"),
    ],
)
def test_a_bend_says_where_it_begins(name, beyond, says):
    with pytest.raises(InputError, match=says):
        Correction(name, 0.01, beyond=beyond)


@pytest.mark.parametrize("error", [8.0, -8.0])
def test_an_s_of_eight_cubic_centimetres_is_taken_out_to_rounding(error):
    stroke, true = 215.0 * CM3_PER_REV, np.linspace(5.0, 215.0, 43) * CM3_PER_REV
    x = true / stroke
    logged = true + error * CM3_PER_REV * 6.0 * np.sqrt(3.0) * x * (1.0 - x) * (1.0 - 2.0 * x)
    right = unswung(logged, Correction("displacement_s_shape", error * CM3_PER_REV, beyond=stroke))
    np.testing.assert_allclose(right, true, rtol=1e-7)


def test_what_has_grown_stays_and_what_has_a_window_ends_with_it():
    assert Correction("pressure_creep", 1e5, during=((100.0, 200.0),)).ends == math.inf
    assert Correction("pressure_offset", 1e5, during=((100.0, 200.0), (300.0, 400.0))).ends == 400.0
    assert Correction("pressure_offset", 1e5).ends == math.inf


# -- what each of them is, by hand: name -> kind, unit, typical, least and largest value, columns that are wrong, those
# that it needs besides, and what else is said of it
BOTH, SPEEDS = ("pressure_a", "pressure_b"), ("motor_speed", "drum_speed", "shaft_angle")
DRIVE, LINES = (*BOTH, "motor_torque"), (*BOTH, "displacement")
GROUP, NOT_LIVE, OIL = {"by_group": True}, {"live": False}, ("oil_temperature",)
GAS = GROUP | NOT_LIVE | {"has_time_constant": True}
CM3, LEAK = 1e-6 / (2.0 * math.pi), ("signal", "m^3/s/Pa", 1.4e-11, 0.0, 1e-9, ("speed_reference",), LINES)
OF_BACKLOG = NOT_LIVE | {"has_time_constant": True, "course": "backlog"}
IS = {
    "pressure_offset": ("signal", "Pa", 1.5e5, -50e5, 50e5, BOTH[:1], (), GROUP),
    "pressure_thermal_zero": ("signal", "Pa/K", 1e4, -5e5, 5e5, BOTH[:1], OIL, GROUP),
    "pressure_thermal_bow": ("signal", "Pa/K^2", 500.0, -2e4, 2e4, BOTH[:1], OIL, GROUP | {"by_warmth": 2}),
    "pressure_scale": ("signal", "1", 0.01, -0.2, 0.2, BOTH, (), GROUP),
    "pressure_scale_a": ("signal", "1", 0.01, -0.2, 0.2, BOTH[:1], (), GROUP),
    "pressure_thermal_span": ("signal", "1/K", 5e-4, -0.01, 0.01, BOTH, OIL, GROUP),
    "pressure_thermal_span_a": ("signal", "1/K", 5e-4, -0.01, 0.01, BOTH[:1], OIL, GROUP),
    "pressure_curvature": ("signal", "1/Pa", 5e-10, -5e-9, 5e-9, BOTH, (), GROUP),
    "pressure_curvature_a": ("signal", "1/Pa", 5e-10, -5e-9, 5e-9, BOTH[:1], (), GROUP),
    "pressure_bend": ("signal", "1", 0.02, -0.5, 0.5, BOTH, (), GROUP | {"bends_in": "Pa"}),
    "displacement_offset": ("signal", "m^3/rad", CM3, -20 * CM3, 20 * CM3, LINES[2:], (), GROUP),
    "displacement_thermal_zero": ("signal", "m^3/rad/K", 0.1 * CM3, -2 * CM3, 2 * CM3, LINES[2:], OIL, GROUP),
    "pressure_creep": ("signal", "Pa", 3e5, -50e5, 50e5, BOTH[:1], (), GROUP | {"grows": True}),
    "displacement_scale": ("signal", "1", 0.01, -0.2, 0.2, LINES[2:], (), GROUP),
    "displacement_curvature": ("signal", "rad/m^3", 100.0, -1e4, 1e4, LINES[2:], (), GROUP),
    "displacement_bend": ("signal", "1", 0.02, -0.5, 0.5, LINES[2:], (), GROUP | {"bends_in": "m^3/rad"}),
    "displacement_s_shape": (
        "signal", "m^3/rad", CM3, -20 * CM3, 20 * CM3, LINES[2:], (), GROUP | {"bends_in": "m^3/rad"}
    ),
    "signal_delay": ("signal", "s", 0.05, -0.5, 0.5, SPEEDS, (), NOT_LIVE),
    "pressure_delay": ("signal", "s", 0.05, -0.5, 0.5, DRIVE, (), NOT_LIVE),
    "signal_clock": ("signal", "1", 1e-3, -5e-3, 5e-3, SPEEDS, (), NOT_LIVE | {"course": "clock"}),
    "pressure_clock": ("signal", "1", 1e-3, -5e-3, 5e-3, DRIVE, (), NOT_LIVE | {"course": "clock"}),
    "signal_buffer": ("signal", "s", 0.1, 0.0, 0.5, SPEEDS, (), OF_BACKLOG | {"course": "buffer"}),
    "pressure_buffer": ("signal", "s", 0.1, 0.0, 0.5, DRIVE, (), OF_BACKLOG | {"course": "buffer"}),
    "signal_backlog": ("signal", "s", 0.1, -0.5, 0.5, SPEEDS, (), OF_BACKLOG),
    "pressure_backlog": ("signal", "s", 0.1, -0.5, 0.5, DRIVE, (), OF_BACKLOG),
    "signal_course": ("signal", "s", 0.1, 0.0, 0.5, SPEEDS, (), NOT_LIVE | {"course": "drawn"}),
    "pressure_course": ("signal", "s", 0.1, 0.0, 0.5, DRIVE, (), NOT_LIVE | {"course": "drawn"}),
    "signal_filter": ("signal", "s", 0.05, 0.0, 0.5, SPEEDS, (), NOT_LIVE),
    "pressure_filter": ("signal", "s", 0.05, 0.0, 0.5, DRIVE, (), NOT_LIVE),
    "layer_radius": ("geometry", "m", 0.06, -0.5, 0.5, (), (), {"by_layer": True}),
    "tare_load": ("load", "kg", 2000.0, -2e4, 2e4, ("hook_load",), (), {}),
    "tare_creep": ("load", "kg", 2000.0, -2e4, 2e4, ("hook_load",), (), {"grows": True}),
    "wire_weight": ("load", "kg/m", 12.0, 0.0, 200.0, ("hook_load",), ("wire_out",), {}),
    "inertia": ("inertia", "kg*m^2", 0.2, -1e5, 1e5, (), (), {}),
    "accumulator_warmth": ("signal", "1", 0.02, -0.2, 0.2, BOTH[:1], BOTH[1:], GAS),
    "accumulator_slow_warmth": ("signal", "1", 0.02, -0.2, 0.2, BOTH[:1], BOTH[1:], GAS),
    "accumulator_heat": ("signal", "1", 1.0, -10.0, 10.0, BOTH[:1], BOTH[1:], GAS),
    **{f"{kind}_leakage": (*LEAK, GROUP | NOT_LIVE) for kind in ("slip", "orifice", "opening_gap", "isoviscous")},
    "entrained_air": ("signal", "m^3", 6e-4, 0.0, 0.1, ("speed_reference",), LINES, GROUP | NOT_LIVE),
}  # fmt: skip
USUAL = {
    "by_group": False, "by_layer": False, "has_time_constant": False, "live": True, "grows": False, "bends_in": "",
    "course": "", "by_warmth": 1,
}  # fmt: skip


@pytest.mark.parametrize("name", DECLARED)
def test_a_correction_is_declared_with_what_is_wrong_and_how_far_it_may_be(name):
    own, (kind, unit, typical, lower, upper, channels, reads, more) = DECLARED[name], IS[name]
    assert (own.name, own.parameter.name, own.kind, own.parameter.unit) == (name, name, kind, unit)
    bounds = (own.parameter.typical, own.parameter.lower, own.parameter.upper)
    assert bounds == pytest.approx((typical, lower, upper), rel=1e-9)
    assert (own.channels, own.reads) == (channels, reads)
    assert {each: getattr(own, each) for each in USUAL} == USUAL | more


def test_the_words_of_a_correction_say_which_signals_it_is_about():
    assert "how late the speed is logged" in DECLARED["signal_delay"].doc
    assert "how late the pressures (or the motor torque) are logged" in DECLARED["pressure_delay"].doc
    for name in ("pressure_scale", "pressure_thermal_span", "pressure_curvature"):
        assert "both ports" in DECLARED[name].doc
        assert "at port A" in DECLARED[f"{name}_a"].doc
    assert len({each.doc for each in DECLARED.values()}) == len(DECLARED)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"std": -1.0}, "std must be a finite number from 0, found -1"),
        ({"std": math.inf}, "std must be a finite number"),
        ({"time_constant": 0.0}, "time_constant must be above 0 s, found 0"),
        ({"time_constant": math.inf}, "time_constant must be above 0 s, found inf"),
    ],
)
def test_a_sigma_below_zero_and_a_time_of_nothing_are_none(more, said):
    with pytest.raises(InputError, match=said):
        Correction("accumulator_warmth", 0.01, **{"time_constant": 60.0} | more)
    assert Correction("accumulator_warmth", 0.01, std=0.0, time_constant=60.0).std == 0.0


@pytest.mark.parametrize(
    ("name", "more", "said"),
    [
        ("signal_delay", {"course": DRAWN}, "'signal_delay' has no course"),
        ("signal_course", {}, "'signal_course' needs course: points"),
        ("signal_course", {"course": ((-1.0, 0.0), (5.0, 1.0))}, "times from 0 s and shares of -1 to 1"),
        ("signal_course", {"course": ((0.0, 0.0), (5.0, 1.1))}, "times from 0 s and shares of -1 to 1"),
        ("signal_course", {"course": ((0.0, math.nan), (5.0, 1.0))}, "times from 0 s and shares of -1 to 1"),
        ("signal_course", {"course": ((0.0, 0.0), (math.inf, 1.0))}, "times from 0 s and shares of -1 to 1"),
        ("signal_course", {"course": ((5.0, 0.0), (0.0, 1.0))}, "in turn and more than 1 s, twice the largest delay"),
        ("signal_course", {"course": ((0.0, 0.0), (1.0, 1.0))}, "in turn and more than 1 s, twice the largest delay"),
        ("signal_course", {"course": ((0.0, 0.0), (0.4, 1.0)), "upper": 0.2}, "more than 0.4 s, twice the largest"),
    ],
)
def test_a_delays_course_has_points_between_which_nothing_is_logged_before_what_came_before(name, more, said):
    with pytest.raises(InputError, match=said):
        Correction(name, 0.05, **more)
    assert Correction("signal_course", 0.1, upper=0.2, course=((0.0, -1.0), (0.41, 1.0))).course[1] == (0.41, 1.0)


def test_beyond_its_points_a_delay_is_what_it_is_at_the_nearer_end():
    told = lateness("drawn", np.array([0.0, 2.0, 11.0, 45.0, 90.0]), None, DRAWN)
    assert told == pytest.approx([0.25, 0.25, 0.625, 0.5, 0.5])


def test_a_bend_that_begins_nowhere_is_none():
    for beyond in (0.0, math.inf):
        with pytest.raises(InputError, match="beyond must be above 0 Pa"):
            Correction("pressure_bend", 0.01, beyond=beyond)


@pytest.mark.parametrize(
    ("name", "ties"),
    [
        ("pressure_offset", ({"groups": ("active",)}, {"groups": ("passive",)})),
        ("layer_radius", ({"layers": (1,)}, {"layers": (2,)})),
        ("tare_load", ({"during": ((0.0, 1.0),)}, {"during": ((1.0, 2.0),)})),
        ("pressure_bend", ({"beyond": 1e7}, {"beyond": 2e7})),
    ],
)
def test_one_error_may_stand_for_each_group_layer_time_and_place_to_bend(name, ties, crane2_model):
    first, second = (Correction(name, 0.01, **each) for each in ties)
    assert len(replace(crane2_model, corrections=(first, second)).corrections) == 2
    with pytest.raises(InputError, match=f"'{name}' stands twice"):
        replace(crane2_model, corrections=(first, replace(first, value=0.02)))


@pytest.mark.parametrize(("time", "there"), [(9.9, False), (10.0, True), (20.0, True), (20.1, False), (31.0, True)])
def test_a_window_holds_from_its_first_second_to_its_last(time, there):
    assert Correction("tare_load", 1.0, during=((10.0, 20.0), (30.0, math.inf))).holds(time) is there


def test_a_node_is_told_of_the_last_end_of_what_is_over(crane_150t, crane2_model):
    ended = tuple(Correction("signal_delay", 0.05, during=((0.0, end),)) for end in (700.0, 400.0))
    corrector = SampleCorrector(crane_150t, replace(crane2_model, corrections=ended), since=1000.0)
    assert corrector.past == {"signal_delay": 700.0}
    assert past_corrections(corrector) == "signal_delay until 700 s"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["slip_leakage", "entrained_air"])
def test_motors_that_are_swung_out_tell_no_lost_speed(name, truth, crane_150t, crane2_model):
    """At a displacement of zero the commanded speed was without bound, with a warning of NumPy's."""
    stroke = truth["active.displacement"].copy()
    stroke[10:20], stroke[20:30] = 0.0, 0.009 * crane_150t.max_displacement
    stroke[40:50] = -0.05 * crane_150t.max_displacement  # past centre the oil tells it again
    logged = replace(truth, columns={**truth.columns, "active.displacement": stroke})
    correction = replace(typical(name, 1.0), groups=("active",))
    run, _ = corrected(logged, crane_150t, replace(crane2_model, corrections=(correction,)))
    assert np.isnan(run["speed_reference"][10:30]).all()
    assert np.isfinite(run["speed_reference"][30:]).all()
    assert np.isfinite(run["speed_reference"][:10]).all()
