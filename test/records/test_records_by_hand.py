"""Single values of what records are made of: ages, ranges of a crane file, units, telemetry, a benchmark's speeds."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.io import savemat

from winch_friction.importing.cells import as_column
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import registered_terms
from winch_friction.physics.friction.correction import Correction
from winch_friction.records.corrections import corrections_content, read_corrections
from winch_friction.records.crane_file import MOST_MOTORS, NUMBERS, RADIUS, check_ranges
from winch_friction.records.emps import FORCE_GAIN, read_emps
from winch_friction.records.input_mapping import InputMapping, bag_options_of
from winch_friction.records.model_file import model_from_content, model_to_text
from winch_friction.records.plain import finite
from winch_friction.records.runs import _jumping, read_run
from winch_friction.records.sample_stream import SIMULTANEOUS, InputHold, SampleStream
from winch_friction.records.strict_yaml import Section, parse_yaml
from winch_friction.records.telemetry import Telemetry, estimates, faults, inputs, state
from winch_friction.records.topics import TopicMap
from winch_friction.records.unit_names import SPELLINGS, conversion_to_si

COULOMB = registered_terms()["coulomb"].parameters[0].name

# -- ages
PRESSURE = "main.pressure_a"


def hold():
    return InputHold(groups=("main",), max_age=0.1, max_ages={"hook_load": 2.0, "displacement": 0.5})


@pytest.mark.parametrize(
    ("column", "limit"), [(PRESSURE, 0.1), ("main.displacement", 0.5), ("hook_load", 2.0), ("motor_speed", 0.1)]
)
def test_a_value_is_shown_until_its_age_is_beyond_its_limit(column, limit):
    held = hold()
    assert held.limit(column) == limit
    assert held.put(column, 8.0, 3e-5)
    for age, shown in ((0.0, True), (0.99 * limit, True), (1.01 * limit, False)):
        sample = held.sample(8.0 + age)
        value = getattr(sample.groups["main"], column.rpartition(".")[2]) if "." in column else getattr(sample, column)
        assert (value == 3e-5) == shown
    exact = InputHold(max_age=0.5, max_ages={})
    exact.put("motor_speed", 1.0, 7.0)
    assert exact.sample(1.5).motor_speed == 7.0  # at the limit itself


def test_a_limit_that_is_set_anew_holds_at_once():
    held = hold()
    held.put(PRESSURE, 8.0, 1e7)
    assert math.isnan(held.sample(8.3).groups["main"].pressure_a)
    held.max_age = 0.4
    assert held.sample(8.3).groups["main"].pressure_a == 1e7
    held.max_ages = {PRESSURE: 0.2, "pressure_a": 9.0}  # its own name goes before its channel's
    assert math.isnan(held.sample(8.3).groups["main"].pressure_a)


def test_a_sample_shows_the_newest_value_that_is_not_later_than_itself():
    held = hold()
    for time, value in ((1.0, 10.0), (1.02, 20.0), (1.02, 21.0), (1.04, 30.0)):
        assert held.put("motor_speed", time, value)  # of two of one stamp the one that came last
    assert not held.put("motor_speed", 1.03, 99.0)  # older than what is held
    shown = [held.sample(time).motor_speed for time in (1.0, 1.01, 1.02, 1.03, 1.04, 1.06)]
    assert shown == [10.0, 10.0, 21.0, 21.0, 30.0, 30.0]
    assert math.isnan(held.sample(0.99).motor_speed)
    assert held.sample(1.0 - 0.5 * SIMULTANEOUS).motor_speed == 10.0  # a stamp's rounding
    assert [held.stamp("motor_speed", time) for time in (1.01, 1.05)] == [1.0, 1.04]
    assert held.ages(1.1) == pytest.approx({"motor_speed": 0.06})
    assert held.ages(1.0) == {"motor_speed": 0.0}
    held.drop_after(1.04)
    assert held.sample(1.05).motor_speed == 30.0  # as late as said, not later
    held.drop_after(1.03)
    assert math.isnan(held.sample(1.05).motor_speed)


@pytest.mark.parametrize(("time", "value"), [(1.0, math.nan), (1.0, math.inf), (math.nan, 5.0), (1.0, 1e9)])
def test_what_no_sensor_means_is_not_held(time, value):
    held = hold()
    assert not held.put("motor_speed", time, value)
    assert held.ages(2.0) == {}


@pytest.mark.parametrize(("stroke", "taken"), [(1.0, True), (2.0, True), (2.1, False), (-2.0, True), (-2.1, False)])
def test_a_displacement_of_more_than_twice_the_largest_is_a_wrong_scale(stroke, taken):
    topics = TopicMap(groups=("main",), gear_ratio=50.0, max_displacement=3e-5)
    stream = SampleStream(topics, InputHold(groups=("main",)))
    message = SimpleNamespace(name=["main_swash"], position=[stroke])
    assert stream.put(topics.inputs["winch/main/displacement"], 1.0, message) == taken
    assert stream.rejected["winch/main/displacement"] == (not taken)
    assert stream.counts["winch/main/displacement"] == 1


def speed_at(stream, stamp, sent):
    source = stream.topics.inputs[stream.topics.speed_topic]
    header = SimpleNamespace(stamp=SimpleNamespace(sec=math.floor(stamp), nanosec=round(stamp % 1.0 * 1e9)))
    message = SimpleNamespace(header=header, name=["winch_motor"], velocity=[5.0], position=[], effort=[])
    return stream.take(source, message, sent)


@pytest.mark.parametrize(("back", "jumped"), [(0.5, False), (0.99, False), (1.01, True), (100.0, True)])
def test_a_speed_that_falls_back_by_more_than_a_second_begins_anew(back, jumped):
    jumps = []
    stream = SampleStream(TopicMap(groups=("main",)), InputHold(max_age=1e6), on_jump=lambda: jumps.append(1))
    assert speed_at(stream, 200.0, 1.0).time == 200.0
    found = speed_at(stream, 200.0 - back, 2.0)
    assert (len(jumps), found is not None) == ((1, True) if jumped else (0, False))


@pytest.mark.parametrize(("sent", "shown"), [(0.9, True), (1.0, True), (1.5, False), (11.0, False), (11.1, True)])
def test_what_has_no_stamp_counts_at_the_next_speed_sent_after_it(sent, shown):
    """And what was sent ten seconds later by its own clock is of another clock."""
    stream = SampleStream(TopicMap(groups=("main",)), InputHold(max_age=1e6))
    load = stream.topics.inputs["winch/hook_load"]
    assert stream.take(load, SimpleNamespace(data=7e3), sent) is None
    assert (speed_at(stream, 50.0, 1.0).hook_load == 7e3) == shown


# -- ranges of a crane file
def test_a_rated_load_is_held_against_what_the_motors_hold_on_the_innermost_layer(crane_150t):
    holds = 11 * crane_150t.max_displacement * 300e5 * 250.0 / (0.8 * GRAVITY)
    for share, told in ((19.9, False), (20.1, True), (1.01 / 200.0, False), (0.99 / 200.0, True)):
        crane = replace(crane_150t, rated_load=share * holds)
        if not told:
            assert check_ranges(crane, "file") is crane
            continue
        with pytest.raises(
            InputError, match=rf"file: rated_load is .* kg, of motors and a gear like these {holds / 200:.4g} "
        ):
            check_ranges(crane, "file")


def test_an_inertia_at_the_motor_is_less_by_the_square_of_the_gear(crane_150t):
    most = 1e7 / 250.0**2
    assert check_ranges(replace(crane_150t, inertia=0.99 * most), "file")
    with pytest.raises(InputError, match=r"inertia \(at the motor shaft\) is 161.6 kg\*m\^2"):
        check_ranges(replace(crane_150t, inertia=1.01 * most), "file")
    direct = replace(crane_150t, gear_ratio=0.5, rated_load=0.0)
    assert check_ranges(replace(direct, inertia=0.99e7, groups={}), "file")  # a gear that speeds up adds nothing


def test_a_shaft_has_two_hundred_motors_at_most(crane_150t):
    crane = replace(crane_150t, rated_load=0.0)
    assert check_ranges(replace(crane, groups={"main": MOST_MOTORS}), "file")
    with pytest.raises(InputError, match="groups: main has 201 motors, of winches 1 ... 200"):
        check_ranges(replace(crane, groups={"main": MOST_MOTORS + 1}), "file")


@pytest.mark.parametrize(
    ("plausible", "value", "meant"),
    [
        (RADIUS, 800.0, "mm (0.8 m)"),
        (RADIUS, 80.0, "cm (0.8 m)"),  # 8 cm as well, and 0.8 m is nearer the usual
        (NUMBERS["gear_ratio"], 0.004, "its inverse (250)"),
        (NUMBERS["rated_pressure"], 450.0, "bar (4.5e+07 Pa)"),
        (NUMBERS["rated_pressure"], 45.0, "MPa (4.5e+07 Pa)"),
        (NUMBERS["rated_speed"], 4800.0, "rpm (502.7 rad/s)"),
        (NUMBERS["max_displacement"], 215.0, "cm^3/rev (3.422e-05 m^3/rad)"),
        (NUMBERS["max_displacement"], 0.215, "l/rev (3.422e-05 m^3/rad)"),
        (NUMBERS["wire_stiffness"], 300.0, "MN (3e+08 N)"),
        (NUMBERS["wire_stiffness"], 0.3, "GN (3e+08 N)"),
        (NUMBERS["rated_load"], 0.05, "t (50 kg)"),
    ],
)
def test_a_slip_is_the_unit_that_makes_the_most_usual_value(plausible, value, meant):
    with pytest.raises(InputError) as said:
        plausible.check(value, "file: it")
    assert str(said.value).endswith(f"did you mean {meant}?")


@pytest.mark.parametrize("plausible", [RADIUS, *NUMBERS.values()])
def test_a_range_holds_its_ends_and_what_is_not_said(plausible):
    for value in (plausible.lower, plausible.upper, plausible.usual, 0.0, math.inf):
        plausible.check(value, "it")
    for value in (0.99 * plausible.lower, 1.01 * plausible.upper, -1.0):
        with pytest.raises(InputError):
            plausible.check(value, "it")


# -- entries of a model file
@pytest.mark.parametrize(
    ("given", "bounds"),
    [
        ({"lower": 0.01, "upper": 0.3}, (10.0, 300.0)),
        ({"upper": 0.3}, (0.0, 300.0)),
        ({"lower": 0.01}, (10.0, 200.0)),
        ({}, (0.0, 200.0)),
    ],
)
def test_bounds_and_std_are_in_the_unit_of_their_value(given, bounds):
    """A Coulomb friction in kN m, whose own bounds are 0 and 200 N m."""
    entry = {"value": 0.15, "unit": "kN*m", "std": 0.02, **given}
    content = {"schema": "winch_friction.model/1", "name": "m", "terms": ["coulomb"], "parameters": {COULOMB: entry}}
    model = model_from_content(content, "file")
    assert model.bounds_of(COULOMB) == pytest.approx(bounds)
    assert (model.values[0], model.std[0]) == pytest.approx((150.0, 20.0))
    again = model_from_content(parse_yaml(model_to_text(model), ""), "file")
    assert again.bounds_of(COULOMB) == pytest.approx(bounds)


@pytest.mark.parametrize("count", [1, 2])
def test_a_correction_comes_back_from_its_entry(count):
    """Alone it is an entry, with another of its name a list; of one group it is not one of all."""
    given = [
        Correction(
            "pressure_offset", 1e5 * (k + 1), std=2e4, source="zero check", groups=(group,), during=((5.0, math.inf),)
        )
        for k, group in enumerate(("active", "passive")[:count])
    ]
    content = corrections_content(given)
    entries = content["pressure_offset"] if count > 1 else [content["pressure_offset"]]
    assert [(each["value"], each["std"], each["groups"]) for each in entries] == [
        (1e5 * (k + 1), 2e4, [group]) for k, group in enumerate(("active", "passive")[:count])
    ]
    again = read_corrections(Section({"corrections": content}, "file"))
    for one, other in zip(given, again, strict=True):
        assert (one.value, one.std, one.groups, one.during) == (other.value, other.std, other.groups, other.during)
        assert (other.source, other.bounds, other.time_constant) == (one.source, one.bounds, None)


# -- units
IN_SI = {
    "rad/s": {"rpm": math.pi / 30.0, "rev/s": 2.0 * math.pi, "rad/s": 1.0, "deg/s": math.pi / 180.0},
    "Pa": {
        "bar": 1e5, "bar_absolute": 1e5, "psi": 6894.757293, "psi_absolute": 6894.757293, "kgf/cm^2": 98066.5,
        "kPa": 1e3, "hPa": 100.0, "mbar": 100.0, "Pa": 1.0, "MPa": 1e6,
    },
    "m^3/rad": {
        "cm^3/rev": 1e-6 / (2.0 * math.pi), "l/rev": 1e-3 / (2.0 * math.pi), "in^3/rev": 16.387064e-6 / (2.0 * math.pi),
        "m^3/rad": 1.0, "cm^3/rad": 1e-6, "m^3/rev": 0.5 / math.pi,
    },
    "kg": {
        "metric_ton": 1e3, "pound": 0.45359237, "gram": 1e-3, "kg": 1.0, "short_ton": 907.18474,
        "long_ton": 1016.0469088,
    },
    "N": {
        "N": 1.0, "kgf": 9.80665, "metric_ton * gravity": 9806.65, "kN": 1e3, "decanewton": 10.0, "meganewton": 1e6,
        "lbf": 4.4482216153,
    },
    "N*m": {"N*m": 1.0, "kN*m": 1e3, "mN*m": 1e-3, "N*cm": 0.01, "lbf*ft": 1.3558179483},
    "degC": {"degC": 1.0, "degF": 5.0 / 9.0, "kelvin": 1.0},
    "m/s": {"m/s": 1.0, "m/min": 1.0 / 60.0, "mm/s": 1e-3, "knot": 1852.0 / 3600.0},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "minute": 60.0, "hour": 3600.0, "day": 86400.0},
    "m": {"m": 1.0, "mm": 1e-3, "cm": 0.01, "km": 1e3, "foot": 0.3048},
    "rad": {"deg": math.pi / 180.0, "rev": 2.0 * math.pi},
    "W": {"kW": 1e3, "metric_horsepower": 735.49875, "W": 1.0, "MW": 1e6},
    "A": {"A": 1.0, "mA": 1e-3},
    "1": {"percent": 0.01, "dimensionless": 1.0},
}  # fmt: skip
OFFSETS = {"bar_absolute": -101325.0, "psi_absolute": -101325.0, "degF": -160.0 / 9.0, "kelvin": -273.15}


@pytest.mark.parametrize("si", SPELLINGS)
def test_every_spelling_of_a_unit_is_worth_as_much(si):
    """One call by the first and the last spelling of each unit: all of them share its name."""
    assert set(SPELLINGS[si]) == set(IN_SI[si])
    for name, spellings in SPELLINGS[si].items():
        for unit in {name, *spellings[:1], *spellings[-1:]}:
            scale, offset = conversion_to_si(unit, si, "")
            assert scale == pytest.approx(IN_SI[si][name], rel=1e-6), unit
            assert offset == pytest.approx(OFFSETS.get(name, 0.0), abs=1e-3), unit


@pytest.mark.parametrize(
    ("unit", "scale"),
    [("Pa(a)", 1.0), ("hPa abs", 100.0), ("mbar (a)", 100.0), ("kPa absolute", 1e3), ("MPa abs.", 1e6)],
)
def test_a_pressure_from_the_vacuum_is_an_atmosphere_less(unit, scale):
    assert conversion_to_si(unit, "Pa", "") == (pytest.approx(scale), pytest.approx(-101325.0))


# -- telemetry
def test_what_is_off_its_course_is_in_millimetres():
    telemetry = Telemetry()
    header = SimpleNamespace(stamp=SimpleNamespace(sec=3, nanosec=500_000_000))
    truth = SimpleNamespace(header=header, name=["winch_motor", "load"], position=[0.0, 0.0123], effort=[77.0, 0.0])
    telemetry.take("simulator/truth", truth)
    for topic, effort in (("compensator/friction_torque", 11.0), ("estimator/friction_torque", 12.0)):
        telemetry.take(topic, SimpleNamespace(header=header, name=["winch_motor"], effort=[effort]))
    points = telemetry.frame()["points"]
    assert points == {
        "truth": [[3.5, 77.0]], "error": [[3.5, 12.3]], "feedforward": [[3.5, 11.0]], "learned": [[3.5, 12.0]],
    }  # fmt: skip
    assert telemetry.frame() == {"time": 3.5, "points": {}, "status": {}, "notes": []}


def test_of_two_nodes_each_says_its_own():
    def status(level=0, message="", **values):
        return {"level": level, "message": message, "values": {k.replace("_", " "): str(v) for k, v in values.items()}}

    found = {
        "w/compensator: parameters": status(speed=1.0, speed_std=9.0),
        "w/estimator: parameters": status(K1=2.0, K1_std=0.5, K1_status="learned", note=3.0),
        "w/estimator: inputs": status(1, "late", winch_rate=40.0, winch_age=0.5),
        "w/compensator: inputs": status(2, "lost", winch_rate=50.0),
        "w/estimator: output": status(3, "old"),
        "w/compensator: output": status(0, "active"),
    }
    assert estimates(found) == [{"parameter": "K1", "value": 2.0, "std": 0.5, "status": "learned"}]
    (only,) = inputs(found)
    assert (only["input"], only["rate"], math.isnan(only["age"])) == ("winch", 50.0, True)
    assert inputs({k: v for k, v in found.items() if "compensator" not in k})[0]["age"] == 0.5
    assert faults(found) == [
        "warning: w/estimator: inputs: late", "error: w/compensator: inputs: lost", "stale: w/estimator: output: old",
    ]  # fmt: skip
    assert state(found) == [("w/estimator: output", "old"), ("w/compensator: output", "active")]


@pytest.mark.parametrize(
    ("value", "plain"),
    [
        (math.nan, None), (math.inf, None), (-math.inf, None), (1.5, 1.5), (0, 0), ("nan", "nan"), (True, True),
        ({1: (math.inf, 2.0)}, {"1": [None, 2.0]}), (np.array([1.0, -np.inf]), [1.0, None]), (np.float64(2.0), 2.0),
    ],
)  # fmt: skip
def test_what_json_has_no_number_for_is_null(value, plain):
    assert finite(value) == plain


# -- parameter files, and a benchmark
def parameters(tmp_path, text):
    path = tmp_path / "params.yaml"
    path.write_text(text)
    return bag_options_of(path)


def test_where_both_nodes_say_something_the_compensator_is_heard(tmp_path):
    text = "".join(
        f"{node}:\n  ros__parameters:\n    {key}: {value}\n"
        for node, key, value in (
            ("/w/compensator", "pressure_reference", "absolute"), ("/w/estimator", "pressure_reference", "gauge"),
        )
    )  # fmt: skip
    assert parameters(tmp_path, text)["pressure_reference"] == "absolute"
    assert parameters(tmp_path, text.replace("compensator", "other"))["pressure_reference"] == "gauge"


@pytest.mark.parametrize(("speed", "motor"), [("winch_drum", False), ("shaft", True)])
def test_a_speed_of_another_joint_than_the_drums_is_the_motors(speed, motor):
    found = InputMapping(speed_joint=speed).joints()
    assert found.get("motor_joint") == (speed if motor else None)
    assert (found["speed_joint"], found["drum_joint"]) == (speed, "winch_drum")


@pytest.mark.parametrize("causal", [False, True])
def test_a_benchmarks_speed_is_its_positions_slope_and_the_reference_its_own(causal, tmp_path):
    """5 Hz pass a filter of 100 Hz; what goes one way is late by its delay, 4.0 ms, and half a sample."""
    time = np.arange(3000) * 1e-3
    way = lambda t: np.sin(2.0 * np.pi * 5.0 * t) / (2.0 * np.pi * 5.0)
    path = tmp_path / "emps.mat"
    savemat(path, {"t": time, "qm": way(time), "qg": 2.0 * time, "vir": 0.5 + 0.0 * time})
    run = read_emps(path, causal)
    late = 4.02e-3 + 0.5e-3 if causal else 0.0
    inner = slice(300, -300)
    np.testing.assert_allclose(run["motor_speed"][inner], np.cos(2.0 * np.pi * 5.0 * (time - late))[inner], atol=3e-3)
    np.testing.assert_allclose(run["speed_reference"], 2.0)
    np.testing.assert_allclose(run["motor_torque"], 0.5 * FORCE_GAIN)
    np.testing.assert_array_equal(run["shaft_angle"], way(time))


def test_a_benchmarks_filter_halves_the_power_at_a_hundred_hertz(tmp_path):
    """Passed forth and back: half the amplitude."""
    time = np.arange(3000) * 1e-3
    path = tmp_path / "emps.mat"
    savemat(path, {"t": time, "qm": np.sin(2.0 * np.pi * 100.0 * time), "qg": time, "vir": time})
    speed = read_emps(path)["motor_speed"][500:-500]
    assert np.abs(speed).max() == pytest.approx(0.5 * np.sin(0.2 * np.pi) / 1e-3, rel=0.02)


def test_a_digit_of_a_coarse_transducer_that_stands_still_is_no_jump():
    """Most of its samples are as the one before: what it moves by, when it does, tells a jump."""
    values = np.zeros(200)
    values[[30, 60, 90, 120, 150]] = 1.0
    assert not _jumping(values).any()
    values[100] = 500.0
    assert np.flatnonzero(_jumping(values)).tolist() == [100]


def test_numbers_of_numpy_are_written_as_plain_ones_and_what_is_no_number_as_null():
    given = {
        1: np.float32("nan"),
        "b": (np.int64(3), np.bool_(True)),
        "c": np.array(np.inf),
        "d": np.array([1.0, np.nan]),
    }
    found = finite(given)
    assert found == {"1": None, "b": [3, True], "c": None, "d": [1.0, None]}
    assert [type(each) for each in found["b"]] == [int, bool]


@pytest.mark.filterwarnings("error")
def test_a_number_that_no_sensor_says_is_none(tmp_path):
    """1e300 rad/s overflowed in every square: numpy's warnings stood among the lines of `check`."""
    path = tmp_path / "run.csv"
    rows = [f"{0.02 * k:g},{speed},{'1e300' if k == 5 else '1e5'}" for k, speed in enumerate(["1.0"] * 60)]
    path.write_text("\n".join(["time,motor_speed [rad/s],main.pressure_a [Pa]", *rows]))
    run = read_run(path, complete=False)
    assert np.flatnonzero(np.isnan(run["main.pressure_a"])).tolist() == [5]
    assert any("1 of 60 values is not a number, line 7" in each for each in run.warnings)
    path.write_text(path.read_text().replace(",1.0,", ",1e300,"))
    with pytest.raises(InputError, match=r"'motor_speed' is there but holds no number"):
        read_run(path)


@pytest.mark.parametrize("beyond", ["1e300", "-1e101"])
def test_a_cell_that_no_sensor_says_is_named_and_not_taken(beyond):
    for cells in (["1.5"] * 9 + [beyond], [1.5] * 9 + [float(beyond)], ["1.5"] * 8 + ["x", beyond]):
        column = as_column("p", cells, ".", "")
        assert np.isnan(column.values[9])
        assert column.bad[-1][0] == 9
