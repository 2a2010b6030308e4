"""Every hidden effect is physics of its own size, in the place where it arises."""

import ast
from pathlib import Path

import numpy as np
import pytest
from clean_sensors import CLEAN

import winch_friction.simulation.hidden as hidden_package
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.simulation import Simulator, load_scenario, simulate
from winch_friction.simulation.hidden.catalogue import EFFECTS, effect_names

CATALOGUE = [
    "viscosity_temperature", "stribeck", "presliding", "dwell_stiction", "gear_asymmetry", "gear_load_loss",
    "layer_radius", "sheave_bending", "wear_drift", "low_displacement_loss", "port_turbulence", "notch_loss",
    "churning", "high_pressure_mixed", "slip_leakage", "line_pressure_drop", "case_pressure",
    "accumulator_thermal", "inertia_error", "pressure_offset", "pressure_scale", "signal_delay",
    "swivel_offset", "entrained_air", "torque_ripple", "brake_drag", "tare_load",
]  # fmt: skip
CLEAN_RUN = {**CLEAN, "duration": 40.0}


@pytest.fixture(scope="module")
def warm(ahc):
    """Compensation in warm oil, in 2024, with the regular wave."""
    oil = {"start": 55.0, "end": 60.0, "time_constant": 60.0}
    return ahc.override({**CLEAN_RUN, "oil_temperature": oil, "start_time": 1.7067456e9})


@pytest.fixture(scope="module")
def steady(crane):
    """Constant speed at 77 t: 600 rpm hoisting, then lowering."""
    points = [[0, 0], [2, 0], [5, 600 * RPM], [17, 600 * RPM], [22, -600 * RPM], [35, -600 * RPM]]
    return load_scenario("test_05").override({**CLEAN_RUN, "duration": 35.0, "profile": {"points": points}})


def friction_at(truth, moment):
    return np.interp(moment, truth.time, truth["friction_torque"])


def test_the_whole_catalogue_can_be_hidden():
    assert sorted(effect_names()) == sorted(CATALOGUE)
    assert all(effect.typical for effect in EFFECTS.values())


def test_hidden_effects_never_import_friction_terms():
    for file in Path(hidden_package.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            assert not [n for n in names if "friction." in n.removeprefix("winch_friction.")], file.name
            assert not [n for n in names if n.startswith("winch_friction.physics.friction")], file.name


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_effect_shows_in_the_logs_and_grows_with_its_size(name, warm, crane, model):
    plain = simulate(warm, crane, model).run

    def change(size):
        run = simulate(warm, crane, model, hidden=[(name, size)]).run
        return sum(np.abs(run[c] - plain[c]).max() / np.abs(plain[c]).max() for c in plain.columns)

    zero, third, whole = (change(size) for size in (0.0, 0.3, 1.0))
    assert zero < 1e-9 or name == "accumulator_thermal"
    assert whole > third > 0.0


FRICTION_SIZES = {  # torque against the motion, N m at the shaft, for 77 t at a shaft speed
    "brake_drag": lambda w: 11 * 3.0,
    "gear_load_loss": lambda w: 0.045 * 77e3 * 9.81 * 1.136 / 250,
    "churning": lambda w: 11 * 3.0 * (w / 209) ** 1.9,
    "stribeck": lambda w: 11 * (155e-7 * 77e3 * 9.81 * 1.136 + 0.562) * np.exp(-w / 24),
}


@pytest.mark.parametrize(("name", "law"), FRICTION_SIZES.items())
def test_friction_effects_have_the_size_of_the_domain(name, law, steady, crane, model):
    plain, hidden = (simulate(steady, crane, model, hidden=h).truth for h in ([], [(name, 1.0)]))
    for moment, sign in ((16.5, 1.0), (34.5, -1.0)):
        speed = abs(np.interp(moment, hidden.time, hidden["motor_speed"]))
        gained = friction_at(hidden, moment) - friction_at(plain, moment)
        assert gained == pytest.approx(sign * law(speed), rel=0.03, abs=0.3)


def test_stribeck_is_111_n_m_at_55_t(crane):
    assert 11 * (155e-7 * crane.drum_torque(55e3) + 0.562) == pytest.approx(111, abs=1)


def test_wear_grows_with_the_date(steady, crane, model):
    epoch, month = 1_704_067_200.0, 30 * 86400.0
    plain = simulate(steady, crane, model).truth
    for months in (0.0, 1.0, 2.0):
        dated = steady.override({"start_time": epoch + months * month})
        worn = simulate(dated, crane, model, hidden=[("wear_drift", 1.0)]).truth
        gained = friction_at(worn, 16.5) - friction_at(plain, 16.5)
        assert gained == pytest.approx(11 * 4.0 * months, abs=1.5)


def test_a_delay_delays_the_speed_alone(warm, crane, model):
    plain, late = (simulate(warm, crane, model, hidden=h).run for h in ([], [("signal_delay", 1.0)]))
    shifted = np.interp(plain.time - 0.05, plain.time, plain["motor_speed"])
    assert np.abs(late["motor_speed"] - shifted)[10:].max() < 0.7  # rad/s, of 209
    assert np.array_equal(late["active.pressure_a"], plain["active.pressure_a"])


def test_sensor_errors_leave_the_plant_alone(warm, crane, model):
    plain = simulate(warm, crane, model)
    for name, channel, expected in (
        ("pressure_offset", "active.pressure_a", 1.5 * BAR),
        ("swivel_offset", "active.displacement", CM3_PER_REV),
    ):
        wrong = simulate(warm, crane, model, hidden=[(name, 2.0)])
        assert np.array_equal(wrong.truth["motor_speed"], plain.truth["motor_speed"])
        assert np.allclose(wrong.run[channel] - plain.run[channel], 2.0 * expected)


def test_the_feedback_that_is_off_is_the_driving_groups_in_normal_mode_too(steady, crane, model):
    plain, off = (simulate(steady, crane, model, hidden=h).run for h in ([], [("swivel_offset", 2.0)]))
    assert plain.groups == ("main",)
    assert np.allclose(off["main.displacement"] - plain["main.displacement"], 2.0 * CM3_PER_REV)


def test_air_softens_the_loop_at_low_pressure():
    from winch_friction.simulation.plant.equations import compressibility
    from winch_friction.simulation.plant.parameters import PLANT, record

    loop = record(PLANT, line_volume=1.0, bulk_modulus=1.6e9, air=0.01)[0]
    assert 1.0 / compressibility(loop, 20 * BAR) == pytest.approx(0.96e9, rel=0.01)  # docs/discrepancy.md
    assert 1.0 / compressibility(loop, 200 * BAR) > 1.5e9


def test_a_warm_accumulator_cools(warm, crane, model):
    still = warm.override({"sea": {"kind": "still"}, "duration": 200.0})
    truth = simulate(still, crane, model, hidden=[("accumulator_thermal", 1.0)]).truth
    pressure = truth["passive_pressure_a"]
    assert pressure[0] - pressure[-1] == pytest.approx(0.02 * 300 * BAR * (1 - np.exp(-200 / 60)), rel=0.05)
    assert np.ptp(truth["passive_reported"]) < 0.01 * BAR  # the PLC does not see it


def test_layer_and_tare_are_unknown_to_the_log(warm, crane, model):
    for name in ("layer_radius", "tare_load"):
        run, truth = (lambda r: (r.run, r.truth))(simulate(warm, crane, model, hidden=[(name, 1.0)]))
        assert set(run["wire_layer"]) == {6.0}
        assert run["hook_load"].mean() == pytest.approx(55e3, rel=1e-6)
        assert abs(truth["drum_torque"].mean() / crane.drum_torque(55e3, 6) - 1.0) > 0.02


def test_presliding_winds_up_over_its_angle(steady, crane, model):
    truth = simulate(steady, crane, model, hidden=[("presliding", 1.0)]).truth
    start = truth["motor_speed"] > 0.0
    angle = truth["shaft_angle"] - truth["shaft_angle"][start.argmax()]
    here = (truth["direction"] > 0.1) & (truth["direction"] < 0.9) & (truth.time < 5.0)
    wound = -np.log(1.0 - truth["direction"][here])
    slope = np.polyfit(angle[here], wound, 1)[0]
    assert 1.0 / slope == pytest.approx(np.radians(2.2), rel=0.1)


def test_dwell_makes_break_away_higher(crane, model):
    points = [[0, 0], [30, 0], [31, 60 * RPM], [36, 60 * RPM], [36.5, 0], [36.6, 0], [37.6, 60 * RPM], [45, 60 * RPM]]
    profile = {"sea": {"kind": "still"}, "duration": 45.0, "profile": {"points": points}}
    scenario = load_scenario("ahc_55t_215").override({**CLEAN, **profile})

    def peak(hidden):
        friction = simulate(scenario, crane, model, hidden=hidden).truth["friction_torque"]
        return friction[3000:3300].max(), friction[3700:3900].max()

    rested, moved = np.subtract(peak([("dwell_stiction", 1.0)]), peak([]))
    assert rested > 0.05 * peak([])[0]
    assert moved < 0.6 * rested


def test_unknown_effects_are_refused(ahc, crane, model):
    with pytest.raises(InputError, match="hidden effect 'rust' is not known; known effects are accumulator_thermal"):
        Simulator(ahc, crane, model, hidden=[("rust", 1.0)])


def test_a_log_does_not_betray_what_was_hidden(warm, crane, model):
    run = simulate(warm, crane, model, hidden=[("brake_drag", 1.0)]).run
    assert "brake_drag" not in repr(run.metadata) + run.name


@pytest.mark.parametrize("name", ["brake_drag", "presliding", "slip_leakage", "entrained_air", "signal_delay"])
def test_what_only_takes_cannot_be_negative(name, ahc, crane_150t, crane2_model):
    """A brake of -1 drove the winch, and the runs were written."""
    with pytest.raises(InputError, match=f"hidden effect '{name}=-1': {name} only takes and cannot be negative"):
        simulate(ahc.override({"duration": 1.0}), crane_150t, crane2_model, hidden={name: -1.0})


@pytest.mark.parametrize(
    "name",
    [
        "gear_asymmetry",
        "gear_load_loss",
        "wear_drift",
        "port_turbulence",
        "case_pressure",
        "torque_ripple",
        "tare_load",
        "pressure_offset",
        "inertia_error",
        "layer_radius",
    ],
)
def test_what_lies_on_either_side_may_be_negative(name):
    effect_names()
    EFFECTS[name].refuse(-1.0, "there")
