"""What is asked for is what is simulated: sets of scenarios, limits, loads that can be held, errors put in, FMUs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import GroupSample, Run, Sample
from winch_friction.physics.winch.crane import Drive, Drum
from winch_friction.records.crane_file import load_crane
from winch_friction.records.strict_yaml import config_directory, read_yaml
from winch_friction.simulation import fmu, load_scenario
from winch_friction.simulation.assembly import plant_record, prescribed_motion
from winch_friction.simulation.campaigns import CAMPAIGNS, fitted, gap_campaign, paper_tests
from winch_friction.simulation.model_errors import put_errors
from winch_friction.simulation.motion.measured import load_heave
from winch_friction.simulation.plant_file import PlantFile, load_plant, refuse_other_plant
from winch_friction.simulation.quantities import validated
from winch_friction.simulation.scenario import scenario_from_content
from winch_friction.simulation.sensors.channels import channels
from winch_friction.simulation.simulator import Simulator

GOOD = {"name": "x", "duration": 10, "mode": "ahc", "load": 55000, "displacement": 3.4e-5}
SHARES = (0.02, 0.05, 0.1, 0.15, 0.25, 0.4, 0.6, 0.8, 0.95)
# cm^3/rev, t, layer, degC at the start
CYCLES = [(215, 2, 6, 28), (215, 77, 6, 36), (215, 107, 6, 46), (164, 2, 5, 52), (164, 77, 5, 32), (164, 107, 6, 42),
          (120, 55, 4, 50), (146, 30, 6, 38)]  # fmt: skip
COMPENSATIONS = [(215, 55, 6, 34), (160, 55, 6, 48), (215, 20, 5, 40), (215, 90, 6, 54)]
SEAS = [("regular", 1.5, 10.0), ("jonswap", 2.0, 9.0), ("jonswap", 1.2, 7.0), ("jonswap", 2.5, 12.0)]
FEBRUARY = 1_706_745_600.0  # 2024-02-01


# -- sets of scenarios
def test_the_papers_tests_are_cycles_over_the_pumps_range():
    for built in paper_tests():
        shipped = load_scenario(built.name)
        assert (built.duration, built.mode, built.profile) == (shipped.duration, "normal", shipped.profile)
    assert [CAMPAIGNS[name](3) for name in ("paper_tests", "gap_campaign")] == [paper_tests(), gap_campaign(3)]


def test_the_gap_campaigns_runs_are_drawn_around_their_plan():
    drawn = {"load": [], "oil": [], "warms": [], "wire": [], "day": [], "share": []}
    for seed in range(6):
        runs = gap_campaign(seed)
        names = [f"run_{k + 1:02d}_{'cycle' if k < 8 else 'ahc'}" for k in range(12)]
        assert [run.name for run in runs] == names
        for k, (run, (displacement, load, layer, oil)) in enumerate(zip(runs, CYCLES + COMPENSATIONS, strict=True)):
            assert run.displacement == pytest.approx(displacement * CM3_PER_REV)
            assert (run.wire_layer, run.oil_temperature.time_constant) == (layer, 200.0)
            assert (run.duration, run.mode) == ((175.0, "normal") if k < 8 else (240.0, "ahc"))
            drawn["load"].append(run.load / (1e3 * load))
            drawn["oil"].append(run.oil_temperature.start - oil)
            drawn["warms"].append(run.oil_temperature.end - run.oil_temperature.start)
            drawn["wire"].append(run.wire_out)
            drawn["day"].append((run.start_time - FEBRUARY) / 86400.0 - 5.0 * k)
            if k < 8:
                assert (run.profile.hold, run.profile.ramp, run.profile.rest) == (6.5, 1.5, 1.5)
                assert max(run.profile.pump_shares) <= 1.0
                drawn["share"] += [a / b for a, b in zip(run.profile.pump_shares, SHARES, strict=True)]
            else:
                sea = run.sea
                assert (sea.kind, *list(sea.dict().values())[1:3]) == SEAS[k - 8]
    limits = {"load": (0.95, 1.05), "oil": (-2.0, 2.0), "warms": (4.0, 10.0), "wire": (40.0, 150.0),
              "day": (0.0, 0.3), "share": (0.9, 1.05)}  # fmt: skip
    for name, (low, high) in limits.items():
        spread = high - low
        assert low <= min(drawn[name]) < low + 0.1 * spread, name
        assert high - 0.1 * spread < max(drawn[name]) <= high + 1e-9, name
        assert np.mean(drawn[name]) == pytest.approx(0.5 * (low + high), abs=0.12 * spread), name


def test_the_sets_are_planned_for_the_150_t_crane_and_left_as_they_are_for_it():
    crane, plant = load_crane("crane_150t"), load_plant("winch_150t")
    for scenarios in (gap_campaign(5), paper_tests()):
        assert fitted(scenarios, crane, plant) == scenarios


def smaller(**changes):
    """A crane of half the motors, whose motors and drum are half as large: half the rope's speed, and less
    gear."""
    first = load_crane("crane_150t")
    own = {"name": "own", "groups": {"main": 6, "active": 2, "passive": 4}, "drum": Drum((0.4, 0.5, 0.568)),
           "max_displacement": 0.5 * first.max_displacement, "gear_ratio": 0.8 * first.gear_ratio,
           "rated_load": 0.0}  # fmt: skip
    return replace(first, **{**own, **changes})


def test_another_cranes_runs_are_the_same_shares_of_what_it_can():
    plant = load_plant("winch_150t").copy(update={"crane": "own"})
    pump = plant.pump.copy(update={"flow": plant.pump.flow / 6.0})
    slow = plant.copy(update={"pump": pump})
    for planned, own in zip(gap_campaign(2), fitted(gap_campaign(2), smaller(), slow), strict=True):
        assert own.displacement == pytest.approx(0.5 * planned.displacement)
        motors = 6 / 11  # of either mode
        assert own.load == pytest.approx(planned.load * motors * 0.5 * 0.8 / 0.5)
        assert own.wire_layer == planned.wire_layer - 3
        assert (own.name, own.duration, own.profile) == (planned.name, planned.duration, planned.profile)
        if own.mode == "ahc":
            height = "amplitude" if own.sea.kind == "regular" else "significant_height"
            flow_per_motor = (1 / 6) / (2 / 3 * 0.5)
            assert getattr(own.sea, height) == pytest.approx(getattr(planned.sea, height) * flow_per_motor * 0.5 / 0.8)


def test_no_run_has_more_than_its_share_of_the_rated_load():
    plant = load_plant("winch_150t").copy(update={"crane": ""})
    for rated, share in ((60e3, 0.4), (140e3, 0.8 * 6 / 11)):
        own = fitted(gap_campaign(2), smaller(rated_load=rated), plant)
        assert [run.load for run in own] == pytest.approx([share * run.load for run in gap_campaign(2)])


def test_a_faster_winch_gets_no_higher_sea_and_a_drum_of_few_layers_its_first():
    fast = load_plant("winch_150t").copy(update={"crane": ""})
    own = fitted(gap_campaign(2), smaller(drum=Drum((0.568,))), fast)
    assert [run.sea for run in own] == [run.sea for run in gap_campaign(2)]
    assert {run.wire_layer for run in own} == {1}


def test_runs_without_motors_for_them_are_left_out():
    plant = load_plant("winch_150t").copy(update={"crane": ""})
    assert [run.name for run in fitted(gap_campaign(2), smaller(groups={"main": 3}), plant)] == [
        run.name for run in gap_campaign(2)[:8]
    ]
    with pytest.raises(InputError, match="'own' has motor groups port: a run needs main, or active and passive"):
        fitted(gap_campaign(2), smaller(groups={"port": 3}), plant)


def test_a_set_needs_a_plant_of_the_crane():
    with pytest.raises(InputError, match="plant 'winch_150t' is of crane 'crane_150t', not of 'own'"):
        fitted(gap_campaign(2), smaller(), load_plant("winch_150t"))
    with pytest.raises(InputError, match="scenarios simulate hydraulic winches"):
        fitted(gap_campaign(2), smaller(drive=Drive("electric")), load_plant("winch_150t"))


# -- limits
@pytest.mark.parametrize(
    ("key", "inside", "beyond"),
    [
        ("duration", 14400.0, 14401.0), ("load", 400e3, 400.1e3), ("wire_layer", 1, 0), ("wire_out", 1.1, 1.0),
        ("sea_ramp", 1e-3, 0.0), ("calm_time", 1e-3, 0.0), ("smooth_sign", 0.0, -0.1), ("step", 0.005, 0.0051),
        ("control_period", 0.001, 0.0009), ("control_period", 0.02, 0.021), ("oil_temperature.start", -20.0, -21.0),
        ("oil_temperature.start", 95.0, 96.0), ("oil_temperature.end", 95.0, 96.0),
        ("oil_temperature.time_constant", 1.0, 0.0), ("sensors.rate", 5.0, 4.0), ("sensors.delay", 0.5, 0.51),
        ("sensors.jitter", 0.0, -0.001), ("sensors.dropout_rate", 1.0, 1.1), ("sensors.dropout_length", 0.1, 0.0),
        ("sensors.encoder_counts", 0.0, -1.0), ("control.lead", 0.5, 0.6), ("control.lead", -0.1, -0.2),
        ("control.drive_lag", 0.1, 0.0), ("control.damping", 0.0, -1.0), ("control.damping_time", 0.1, 0.0),
        ("profile.hold", 0.1, 0.0), ("profile.ramp", 0.1, 0.0), ("profile.rest", 0.0, -0.1),
        ("sea", {"kind": "regular", "amplitude": 10, "period": 2.1}, {"kind": "regular", "amplitude": 10, "period": 2}),
        ("sea", {"kind": "regular", "amplitude": 9, "period": 9}, {"kind": "regular", "amplitude": 11, "period": 9}),
        ("sea", {"kind": "jonswap", "significant_height": 15}, {"kind": "jonswap", "significant_height": 16}),
        ("sea", {"kind": "jonswap", "significant_height": 1, "gamma": 1},
         {"kind": "jonswap", "significant_height": 1, "gamma": 0.9}),
        ("sea", {"kind": "jonswap", "significant_height": 1, "gamma": 7},
         {"kind": "jonswap", "significant_height": 1, "gamma": 7.1}),
        ("sea", {"kind": "jonswap", "significant_height": 1, "response": 2},
         {"kind": "jonswap", "significant_height": 1, "response": 2.1}),
        ("water", {"volume": 1, "height": 1, "surface": -1, "wave_share": 1},
         {"volume": 1, "height": 1, "surface": -1, "wave_share": 1.1}),
    ],
)  # fmt: skip
def test_a_scenario_goes_to_its_limits_and_not_beyond(key, inside, beyond):
    scenario = scenario_from_content(GOOD)
    scenario.override({key: inside})
    with pytest.raises(InputError):
        scenario.override({key: beyond})


def test_a_controller_runs_ten_times_a_second_or_faster():
    scenario_from_content({**GOOD, "control_period": 0.1, "sensors": {"rate": 10}})
    with pytest.raises(InputError, match="control_period: must be at most 0.1, found 0.2"):
        scenario_from_content({**GOOD, "control_period": 0.2, "sensors": {"rate": 5}})


def test_what_a_scenario_does_not_say_is_usual():
    found = scenario_from_content({**GOOD, "sea": {"kind": "jonswap", "significant_height": 2}})
    assert (found.drive, found.wire_layer, found.wire_out, found.plant) == ("primary", 6, 50.0, "winch_150t")
    assert (found.sea_ramp, found.calm_at, found.calm_time) == (10.0, None, 30.0)
    assert (found.control_period, found.step, found.start_time) == (0.01, 0.001, 0.0)
    assert (found.smooth_sign, found.presliding, found.viscosity_truth) == (0.0, None, False)
    assert list(found.sea.dict().values()) == ["jonswap", 2.0, 9.0, 3.3, 0.6, None]
    assert list(found.oil_temperature.dict().values()) == [40.0, None, 600.0]
    assert list(found.profile.dict().values()) == [(), (), (), 8.0, 2.0, 2.0]
    assert (found.control.lead, found.control.position_gain, found.control.drive_lag) == (0.0, None, None)
    sensors = found.sensors
    assert (sensors.rate, sensors.jitter, sensors.delay, sensors.encoder_counts) == (50.0, 0.001, 0.0, 1024.0)
    assert (sensors.pressure_noise, sensors.pressure_step) == (0.3 * BAR, pytest.approx(600 * BAR / 4096))
    assert (sensors.displacement_noise, sensors.load_noise, sensors.heave_noise) == (0.0003, 10.0, 0.003)
    assert (sensors.temperature_noise, sensors.dropout_rate, sensors.dropout_length) == (0.05, 0.0, 0.1)
    assert (sensors.noise, sensors.quantisation, sensors.dropout) == (True, True, "nan")


@pytest.mark.parametrize(
    ("key", "inside", "beyond"),
    [
        (("pump", "flow"), 1e-6, 0.0), (("pump", "lag"), 1e-6, 0.0), (("pump", "bandwidth"), 0.0, -1.0),
        (("pump", "damping"), 0.1, 0.0), (("active_loop", "air"), 0.2, 0.21), (("active_loop", "air"), 0.0, -0.01),
        (("accumulator", "exponent"), 1.01, 1.0), (("accumulator", "exponent"), 1.8, 1.81),
        (("accumulator", "thermal_time"), 0.0, -1.0), (("case_leakage",), 0.0, -1e-15), (("leakage",), 0.0, -1e-15),
        (("torque_lag",), 0.01, 0.0), (("presliding",), 1e-6, 0.0), (("wire_damping",), 0.0, -1.0),
    ],
)  # fmt: skip
def test_a_plant_goes_to_its_limits_and_not_beyond(key, inside, beyond):
    path = config_directory() / "plants" / "winch_150t.yaml"
    for value in (inside, beyond):
        content = read_yaml(path)
        place = content if len(key) == 1 else content[key[0]]
        place[key[-1]] = value
        if value == beyond:
            with pytest.raises(InputError, match=f"p.yaml: {'.'.join(key)}: must be"):
                validated(PlantFile, content, "p.yaml")
        else:
            validated(PlantFile, content, "p.yaml")


def test_what_a_plant_does_not_say_is_usual():
    content = read_yaml(config_directory() / "plants" / "winch_150t.yaml")
    for each in (("pump", "lag"), ("accumulator", "exponent")):
        del content[each[0]][each[1]]
    del content["case_leakage"], content["torque_lag"]
    plant = validated(PlantFile, content, "p.yaml")
    assert (plant.pump.lag, plant.pump.bandwidth, plant.pump.damping) == (0.1, 0.0, 1.0)
    assert (plant.accumulator.exponent, plant.accumulator.thermal_time, plant.active_loop.air) == (1.2, 0.0, 0.0)
    assert (plant.case_leakage, plant.torque_lag) == (0.0, 0.05)


@pytest.mark.parametrize(
    ("changes", "holds"),
    [
        ({"mode": "normal"}, 11 * 325e5),  # all motors between relief and boost
        ({}, 3 * 325e5 + 8 * 275e5),  # the passive ones on the accumulator, at their largest
        ({"passive_displacement": 0.5 * 215 * CM3_PER_REV}, 3 * 325e5 + 8 * 0.5 * 275e5),
    ],
)
def test_a_load_is_held_by_the_motors_at_the_relief_pressure(changes, holds, crane):
    plant, largest = load_plant("winch_150t"), 215 * CM3_PER_REV
    load = holds * largest * 250.0 / (GRAVITY * 1.136)
    scenario = scenario_from_content({**GOOD, "displacement": largest, "load": 0.999 * load, **changes})
    refuse_other_plant(scenario, plant, crane)
    said = rf"'x': load {1.001e-3 * load:.4g} t is more than crane 'crane_150t' .* 0 \.\.\. {1e-3 * load:.4g} t"
    with pytest.raises(InputError, match=said):
        refuse_other_plant(scenario.override({"load": 1.001 * load}), plant, crane)


def test_a_plant_or_scenario_of_another_crane_is_refused_by_its_kind(crane):
    plant, scenario = load_plant("winch_150t"), scenario_from_content({**GOOD, "crane": "ours"})
    refuse_other_plant(scenario.override({"crane": "crane_150t"}), plant, crane)
    refuse_other_plant(scenario.override({"crane": ""}), plant.copy(update={"crane": ""}), crane)
    with pytest.raises(InputError, match=r"^scenario 'x' is of crane 'ours', not of 'crane_150t'"):
        refuse_other_plant(scenario, plant, crane)
    with pytest.raises(InputError, match=r"'ours' and plant 'winch_150t' is of crane 'theirs', not of 'crane_150t'"):
        refuse_other_plant(scenario, plant.copy(update={"crane": "theirs"}), crane)


@pytest.mark.parametrize("at", ["displacement", "displacement_schedule"])
def test_motors_swivel_from_a_fiftieth_to_their_largest(at, crane, ahc):
    plant, largest = load_plant("winch_150t"), 215 * CM3_PER_REV

    def asked(share):
        value = share * largest
        return ahc.override({at: value if at == "displacement" else [[0.0, largest], [5.0, value]]})

    for share in (0.0201, 1.0009):
        plant_record(asked(share), crane, plant)
    for share in (0.0199, 1.0011):
        with pytest.raises(InputError, match="is outside the motors'"):
            plant_record(asked(share), crane, plant)


# -- motion
def test_the_tip_comes_to_rest_when_the_sea_calms(ahc, crane):
    time = np.arange(0.0, 60.0, 0.01)
    calm = ahc.override({"sea_ramp": 5.0, "calm_at": 21.0, "calm_time": 10.0})
    height = prescribed_motion(calm, crane, time, 1, 100.0).tip[:, 0]
    whole = 1.5 * np.sin(2.0 * np.pi * time / 10.0)
    full, ended, half = (time >= 5.0) & (time <= 21.0), time >= 31.0, np.isclose(time, [[2.5], [26.0]])
    np.testing.assert_allclose(height[full], whole[full], atol=1e-9)
    np.testing.assert_allclose(height[ended], 0.0, atol=1e-12)
    for each in half:  # the blend is symmetric
        np.testing.assert_allclose(height[each], 0.5 * whole[each], atol=1e-9)


def test_the_tip_has_its_share_of_a_measured_heave_from_where_it_starts(crane):
    scenario = load_scenario("ahc_measured_heave").override({"duration": 40.0, "sea.start": 50.0, "sea.response": 0.4})
    time = np.arange(0.0, 40.0, 0.01)
    tip = prescribed_motion(scenario, crane, time, 1, 100.0).tip
    later = time > 10.0
    measured = load_heave(config_directory() / "examples" / "ship_heave" / "seapath.csv").motion(50.0 + time)
    np.testing.assert_allclose(tip[later, :3], 0.4 * measured[later])


# -- a model's errors in the sensors
def put(ahc, crane, model, *corrections):
    plant, sensors = plant_record(ahc, crane, load_plant("winch_150t")), channels(ahc)
    put_errors(replace(model, corrections=corrections), ahc, crane, plant, sensors)
    return plant[0], dict(zip(sensors.names, sensors.settings, strict=True))


def test_two_errors_of_one_signal_are_both_in_it(ahc, crane, model):
    """One of all groups, one of the active group, and the sensor's own."""
    own = {"sensors.skew": {"motor_speed": 0.03}, "sensors.pressure_offset": {"active.pressure_a": 4e5}}
    active = {"groups": ("active",)}
    _, found = put(
        ahc.override(own), crane, model,
        Correction("pressure_offset", 1e5), Correction("pressure_offset", 2e5, **active),
        Correction("pressure_scale", 0.01), Correction("pressure_scale", 0.02, **active),
        Correction("pressure_curvature", 1e-10), Correction("pressure_curvature", 2e-10, **active),
        Correction("signal_delay", 0.02),
    )  # fmt: skip
    row, passive = found["active.pressure_a"], found["passive.pressure_a"]
    assert (row["offset"], row["scale"], row["curvature"]) == pytest.approx((7e5, 1.01 * 1.02, 3e-10), abs=0.0)
    assert (passive["offset"], passive["scale"], passive["curvature"]) == pytest.approx((1e5, 1.01, 1e-10), abs=0.0)
    assert found["motor_speed"]["delay"] == pytest.approx(0.05)
    assert found["hook_load"]["delay"] == 0.0


def test_bends_are_put_in_the_order_of_where_they_begin(ahc, crane, model):
    bends = [Correction("pressure_bend", value, groups=("active",), beyond=at * BAR) for value, at in
             ((0.01, 90.0), (0.02, 30.0), (0.03, 60.0))]  # fmt: skip
    _, found = put(ahc, crane, model, *bends)
    row = found["active.pressure_b"]
    assert row["bend"][:4].tolist() == [0.02, 0.03, 0.01, 0.0]
    assert row["beyond"][:4] == pytest.approx([30.0 * BAR, 60.0 * BAR, 90.0 * BAR, 0.0])
    many = [replace(bends[0], beyond=k * BAR) for k in range(10, 19)]
    put(ahc, crane, model, *many[:8])
    with pytest.raises(InputError, match="bends in at most 8 places"):
        put(ahc, crane, model, *many)


def test_an_early_signal_makes_all_others_late(ahc, crane, model):
    _, found = put(ahc, crane, model, Correction("signal_delay", -0.04))
    delays = {name: float(row["delay"]) for name, row in found.items()}
    early = {name for name, delay in delays.items() if delay == 0.0}
    assert "motor_speed" in early
    assert {delay for name, delay in delays.items() if name not in early} == {0.04}


def test_what_hangs_beyond_the_load_cells_reading_is_a_mass(ahc, crane, model):
    plant, _ = put(ahc, crane, model, Correction("tare_load", 700.0), Correction("wire_weight", 20.0))
    assert (plant["mass"], plant["wire_mass"]) == pytest.approx((55e3 + 700.0 + 20.0 * ahc.wire_out, 20.0))


# -- the PLC's rows
def plc(dropout, lost):
    groups = {"main": GroupSample(1e5, 2e5, 3e-5)}
    own = SimpleNamespace(
        _scans=SimpleNamespace(lost=[False, lost]), fresh=True, sample="before",
        scenario=SimpleNamespace(sensors=SimpleNamespace(dropout=dropout)),
        _measure=lambda number: Sample(time=10.0 + number, motor_speed=3.0, groups=groups, hook_load=9.0),
    )  # fmt: skip
    Simulator._take(own, 1)
    return own


def test_a_row_is_fresh_when_a_scan_has_come_since_the_last_step(monkeypatch):
    """Sensors at 25 Hz whose rows come 10 ms late, read at 100 Hz."""
    monkeypatch.setattr("winch_friction.simulation.simulator.run_periods", lambda *_: None)
    taken, fresh = [], []
    sensors = SimpleNamespace(delay=0.01, rate=25.0)
    own = SimpleNamespace(
        finished=False, tick=0, feedforward=np.zeros(20), _arguments=(), _scan=0, sample=None, _take=taken.append,
        scenario=SimpleNamespace(sensors=sensors),
    )  # fmt: skip
    for k in range(1, 11):
        own.time = 0.01 * k
        Simulator.step(own)
        fresh.append(own.fresh)
    assert [k for k, each in enumerate(fresh, start=1) if each] == [5, 9]
    assert taken == [1, 2]


def test_a_lost_scan_is_a_row_of_nothing_or_no_row():
    there = plc("nan", False)
    assert (there.sample.time, there.sample.motor_speed, there.sample.hook_load, there.fresh) == (11.0, 3.0, 9.0, True)
    empty = plc("nan", True)
    assert (empty.sample.time, empty.fresh, list(empty.sample.groups)) == (11.0, True, ["main"])
    values = (empty.sample.motor_speed, empty.sample.hook_load, empty.sample.groups["main"].pressure_a)
    assert np.isnan(values).all()
    missing = plc("missing", True)
    assert (missing.sample, missing.fresh) == ("before", False)


@pytest.mark.parametrize(("time", "delay", "rows"), [(0.0, 0.0, 1), (0.019, 0.0, 1), (0.02, 0.0, 2), (1.0, 0.1, 46)])
def test_a_row_is_logged_when_its_scan_has_ended_and_come(time, delay, rows):
    sensors = SimpleNamespace(rate=50.0, delay=delay)
    assert Simulator._logged(SimpleNamespace(time=time, scenario=SimpleNamespace(sensors=sensors))) == rows


# -- FMUs
MAP = """\
schema: winch_friction.fmu/1
inputs:
  speed_in: {column: motor_speed, unit: rpm}
  load_in: {column: hook_load, unit: t}
outputs:
  force_out: {column: rope_force_simulated, unit: kN}
parameters: {gain: 2.5}
"""


class Fmpy:
    """Answers with ten times its second input, half a communication step apart."""

    def __init__(self, step):
        self.step = step

    def read_model_description(self, path, validate):
        names = ("speed_in", "load_in", "force_out", "gain")
        return SimpleNamespace(modelVariables=[SimpleNamespace(name=name) for name in names], coSimulation=True)

    def simulate_fmu(self, path, input, output, start_values, output_interval, start_time, stop_time, fmi_type):
        assert (output, start_values, fmi_type, start_time) == (["force_out"], {"gain": 2.5}, "CoSimulation", 0.0)
        assert output_interval == pytest.approx(self.step)
        assert stop_time == pytest.approx(input["time"][-1])
        self.input = input
        fine = np.arange(0.0, stop_time + 1e-9, 0.5 * output_interval)
        return {"time": fine, "force_out": 10.0 * np.interp(fine, input["time"], input["load_in"])}


@pytest.mark.parametrize(("period", "step"), [(0.02, 0.002), (0.001, 0.001), (0.005, 0.005 / 3.0)])
def test_an_fmu_reads_and_answers_in_its_own_units_at_its_own_step(period, step, tmp_path, monkeypatch):
    (tmp_path / "map.yaml").write_text(MAP)
    (tmp_path / "own.fmu").write_text("")
    foreign = Fmpy(step)
    monkeypatch.setattr(fmu, "_fmpy", lambda: foreign)
    time = 500.0 + period * np.arange(5)
    load = np.array([1e3, np.nan, 3e3, 4e3, np.nan])
    run = Run("r", {"time": time, "motor_speed": np.full(5, np.pi), "hook_load": load}, metadata={"seed": 3})
    found = fmu.simulate_fmu(tmp_path / "own.fmu", fmu.load_fmu_map(tmp_path / "map.yaml"), run)
    np.testing.assert_allclose(foreign.input["time"], time - 500.0, atol=1e-9)
    np.testing.assert_allclose(foreign.input["speed_in"], 30.0)
    np.testing.assert_allclose(foreign.input["load_in"], [1.0, 2.0, 3.0, 4.0, 4.0])  # holes: between what is there
    np.testing.assert_allclose(found["rope_force_simulated"], 1e4 * np.array([1.0, 2.0, 3.0, 4.0, 4.0]))
    assert found.metadata == {"seed": 3, "fmu": "own.fmu"}
    np.testing.assert_array_equal(found["hook_load"], load)


def test_a_column_without_a_number_is_nothing_to_an_fmu():
    assert fmu._without_holes(np.full(3, np.nan)).tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("speed_in:", "spede_in:"), "no variable spede_in; it has force_out, gain, load_in, speed_in"),
        (("gain", "gian"), "no variable gian"),
        (("rope_force_simulated", "rope_force"), "'rope_force' is not a simulated column"),
        (("motor_speed", "shaft_spede"), "'shaft_spede' is no column of a run file"),
    ],
)
def test_what_an_fmu_does_not_have_is_named(change, said, tmp_path, monkeypatch):
    (tmp_path / "map.yaml").write_text(MAP.replace(*change))
    (tmp_path / "own.fmu").write_text("")
    monkeypatch.setattr(fmu, "_fmpy", lambda: Fmpy(0.002))
    run = Run("r", {"time": np.arange(3.0), "motor_speed": np.zeros(3), "hook_load": np.zeros(3)})
    with pytest.raises(InputError, match=said):
        fmu.simulate_fmu(tmp_path / "own.fmu", fmu.load_fmu_map(tmp_path / "map.yaml"), run)
