"""The errors that a model's corrections speak of are in the simulated log, and the corrections take them out again."""

from dataclasses import replace

import numpy as np
import pytest
from clean_sensors import CLEAN

from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY
from winch_friction.physics.corrections import corrected, corrected_crane
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import DECLARED, Action
from winch_friction.simulation import Simulator, simulate

OF_SENSORS = (Action.OFFSET, Action.SCALE, Action.CURVATURE, Action.BEND, Action.S_SHAPE, Action.DELAY)
WITHIN_RUNS = [n for n, d in DECLARED.items() if d.late and n.rpartition("_")[2] not in ("delay", "filter")]
SIGNALS = [n for n, d in DECLARED.items() if d.action in OF_SENSORS and n not in WITHIN_RUNS]
BENDS_AT = {"Pa": 60.0 * BAR, "m^3/rad": 50.0 * CM3_PER_REV}
PLANT = (Action.WARMTH, Action.HEAT, Action.SLIP, Action.FILTER)
OF_THE_PLANT = [n for n, d in DECLARED.items() if n in WITHIN_RUNS or d.action in PLANT]
STILL = {**CLEAN, "sea": {"kind": "still"}, "duration": 20.0}


@pytest.fixture
def scenario(ahc):
    return ahc.override({**CLEAN, "duration": 40.0, "oil_temperature": {"start": 55.0}})


def wrong(model, name, size=1.0, **more):
    return replace(model, corrections=(Correction(name, size * DECLARED[name].parameter.typical, **more),))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("name", SIGNALS)
def test_a_signal_is_wrong_in_the_log_and_right_again(name, sign, scenario, crane, model):
    plain = simulate(scenario, crane, model).run
    more = {"during": ((-2.0, -1.0),)} if DECLARED[name].grows else {}  # grown long ago
    more |= {"beyond": BENDS_AT[DECLARED[name].bends_in]} if DECLARED[name].bends_in else {}
    more |= {"beyond": 300.0 * CM3_PER_REV} if DECLARED[name].action is Action.S_SHAPE else {}
    erring = wrong(model, name, sign, groups=("active",) if DECLARED[name].by_group else (), **more)
    log = simulate(scenario, crane, erring).run
    right, same = corrected(log, crane, erring)
    assert same is crane
    # an early speed is a log whose other signals are late
    shift = DECLARED[name].parameter.typical if DECLARED[name].action is Action.DELAY and sign < 0.0 else 0.0
    for column in right.columns:
        if column in ("time", "motor_speed"):
            continue
        expected = np.interp(right.time - shift, plain.time, plain[column])
        # pressures jump at a reversal within a sample, so the mean error counts where samples are interpolated
        error = np.sqrt(np.mean((right[column] - expected)[60:-60] ** 2))
        assert error < 2e-3 * np.abs(plain[column]).max() + 1e-9, column
    speed = np.interp(right.time - shift, plain.time, plain["motor_speed"])
    assert np.corrcoef(right["motor_speed"][60:-60], speed[60:-60])[0, 1] > 0.99999
    changed = [c for c in plain.columns if np.abs(log[c] - plain[c]).max() > 1e-3 * np.abs(plain[c]).max()]
    assert changed


def test_an_s_goes_on_straight_beyond_its_stroke(scenario, crane, model):
    """As what takes it out has it: a feedback that shows more than the stroke is not bent back."""
    plain = simulate(scenario, crane, model).run
    stroke = 0.8 * float(plain["active.displacement"].max())
    erring = wrong(model, "displacement_s_shape", groups=("active",), beyond=stroke)
    log = simulate(scenario, crane, erring).run
    assert np.abs(log["active.displacement"] - plain["active.displacement"]).max() > 0.5 * CM3_PER_REV
    right, _ = corrected(log, crane, erring)
    np.testing.assert_allclose(right["active.displacement"], plain["active.displacement"], rtol=1e-6)


def test_a_thermal_error_needs_one_temperature(ahc, crane, model):
    warming = ahc.override({**CLEAN, "oil_temperature": {"start": 30.0, "end": 50.0}})
    with pytest.raises(InputError, match="pressure_thermal_zero needs one temperature") as refused:
        simulate(warming, crane, wrong(model, "pressure_thermal_zero"))
    assert "\n" not in str(refused.value)


def test_only_the_named_group_errs(scenario, crane, model):
    plain = simulate(scenario, crane, model).run
    log = simulate(scenario, crane, wrong(model, "pressure_offset", groups=("passive",))).run
    np.testing.assert_allclose(log["passive.pressure_a"] - plain["passive.pressure_a"], 1.5 * BAR, rtol=1e-9)
    np.testing.assert_array_equal(log["active.pressure_a"], plain["active.pressure_a"])


def test_an_error_for_a_time_is_in_the_runs_of_that_time(scenario, crane, model):
    for start, there in ((1.7e9, False), (1.8e9, True)):
        own = scenario.override({"start_time": start})
        plain = simulate(own, crane, model).run
        erring = wrong(model, "pressure_offset", during=((1.75e9, float("inf")),))
        log = simulate(own, crane, erring).run
        np.testing.assert_allclose(log["active.pressure_a"] - plain["active.pressure_a"], 1.5 * BAR * there, rtol=1e-9)
        right, _ = corrected(log, crane, erring)
        np.testing.assert_allclose(right["active.pressure_a"], plain["active.pressure_a"], rtol=1e-9)


@pytest.mark.parametrize(("name", "size"), [("tare_load", 1.0), ("tare_load", -1.0), ("wire_weight", 1.0)])
def test_the_load_cell_misses_what_hangs(name, size, ahc, crane, model):
    erring = wrong(model, name, size)
    result = simulate(ahc.override(STILL), crane, erring)
    right, _ = corrected(result.run, crane, erring)
    hanging = result.truth["drum_torque"][-1] / (GRAVITY * crane.drum.radius(6))
    assert right["hook_load"][-1] == pytest.approx(hanging, rel=1e-4)
    missing = erring.corrections[0].value * (ahc.wire_out if name == "wire_weight" else 1.0)
    assert result.run["hook_load"][-1] == pytest.approx(hanging - missing, rel=1e-4)


def test_radius_and_inertia_are_the_corrected_cranes(ahc, crane, model):
    erring = replace(
        model,
        corrections=(
            Correction("layer_radius", -0.05), Correction("layer_radius", 0.02, layers=(6,)),
            Correction("layer_radius", 0.3, layers=(2,)), Correction("inertia", 0.4),
        ),
    )  # fmt: skip
    true = corrected_crane(crane, erring.corrections)
    plant = Simulator(ahc, crane, erring)._plant[0]
    assert plant["radius"] == pytest.approx(crane.drum.radius(6) - 0.03)
    assert plant["metres_per_radian"] == pytest.approx(true.drum.radius(6) / crane.gear_ratio)
    assert plant["inertia"] == pytest.approx(true.inertia)
    truth = simulate(ahc.override(STILL), crane, erring).truth
    assert truth["drum_torque"][-1] == pytest.approx(true.drum_torque(ahc.load, 6), rel=1e-4)


@pytest.mark.parametrize("name", OF_THE_PLANT)
def test_what_the_plant_makes_itself_is_refused_by_name(name, ahc, crane, model):
    more = {"time_constant": 60.0} if DECLARED[name].has_time_constant else {}
    more |= {"course": ((0.0, 0.0), (60.0, 1.0))} if DECLARED[name].course == "drawn" else {}
    with pytest.raises(InputError, match=f"{name}.*--hide"):
        Simulator(ahc, crane, wrong(model, name, **more))


def test_without_corrections_the_log_is_as_before(scenario, crane, model):
    sensors = Simulator(scenario, crane, model).channels.settings
    assert (sensors["delay"] >= 0.0).all()
    assert (sensors["scale"] == 1.0).all()
    assert (sensors["offset"] == 0.0).all()
