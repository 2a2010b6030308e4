"""The commissioning check: ordinary runs pass, mistakes are named, on drawn cranes of a generator of its own."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from spoils import spoils

from campaign import rig
from campaign.second_rig import SETS, write_set
from winch_friction.commissioning.balance import closure
from winch_friction.commissioning.channels import first_contradiction
from winch_friction.commissioning.check import diagnosed, quick_check
from winch_friction.commissioning.commissioning import check
from winch_friction.commissioning.diagnose import Diagnosis
from winch_friction.commissioning.other_cranes import known_cranes
from winch_friction.commissioning.view import view_of
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Drum
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import read_run

PRACTICE = Path(__file__).parents[2] / "config" / "examples" / "practice_150t"
LENGTH = 0.3  # of a campaign's runs, to be quick
WORLDS = ((0, rig.DRAWN), (3, rig.DRAWN), (1, "rough"))
SOME = (1, 4, 8, 10)  # of the twelve runs: two of constant speeds, two of heave compensation
# every mistake in one world; the campaign has them in many
OF_WORLD = {(0, rig.DRAWN): slice(1, None, 4), (3, rig.DRAWN): slice(3, None, 4), (1, "rough"): slice(0, None, 2)}
RIGHT = 0.9  # share of first causes that must be right; the docs say what the campaign gives


@cache
def world(seed, flavour, tmp):
    folder = tmp / f"{flavour}_{seed}"
    crane, model = rig.write_world(folder, rig.world_of(seed, flavour))
    return load_crane(crane), load_model(model)


@cache
def columns_of(seed, flavour, *effects):
    return rig.make_dataset(seed, flavour, effects, length=LENGTH)


def runs_of(columns):
    return [Run(f"run_{k + 1:02d}", each) for k, each in enumerate(columns)]


@pytest.fixture(scope="session")
def tmp(tmp_path_factory):
    return tmp_path_factory.mktemp("worlds")


# some effects in each world; the others are `make test-long`'s
IN_WORLD = {("", 0), ("tare_load", 0), ("tare_load", 1), ("stribeck", 1), ("", 2)}


@pytest.mark.parametrize(
    ("effect", "seed", "flavour"),
    [
        pytest.param(effect, *world, marks=[] if (effect, k) in IN_WORLD else pytest.mark.long)
        for effect in ("", "tare_load", "stribeck")
        for k, world in enumerate(WORLDS)
    ],
)
def test_friction_and_hidden_effects_are_no_mistakes(seed, flavour, effect, tmp):
    crane, model = world(seed, flavour, tmp)
    runs = runs_of(columns_of(seed, flavour, *([(effect, 2.0)] if effect else [])))
    for share in (0.6, 1.0, 1.4):
        wrong = model.with_values([share * value for value in model.values])
        assert first_contradiction(quick_check(runs, crane, wrong)) is None
    assert first_contradiction(quick_check(runs, crane)) is None


def on_a_soft_wire(run, crane, stiffness, damping=0.03):
    """The run with the pressures of a load that swings: rope as a spring and a damper, stepped sample by sample."""
    lever = np.array(crane.drum.layer_radii)[np.rint(run["wire_layer"]).astype(int) - 1] / crane.gear_ratio
    own, step = stiffness / run["wire_out"] / run["hook_load"], float(np.median(np.diff(run.time)))
    rigid = lever * np.gradient(run["motor_speed"], run.time)
    stretch = rate = 0.0
    pulled = np.empty(len(run.time))
    for k, mode in enumerate(own):
        pulled[k] = mode * stretch + 2.0 * damping * np.sqrt(mode) * rate
        rate += step * (rigid[k] - pulled[k])
        stretch += step * rate
    more = run["hook_load"] * lever * (pulled - rigid) / (crane.groups["main"] * run["main.displacement"])
    return replace(run, columns={**run.columns, "main.pressure_a": run["main.pressure_a"] + more})


def test_a_load_that_swings_on_a_soft_wire_is_no_contradiction(tmp):
    crane, model = world(0, "quiet", tmp)
    run = runs_of(columns_of(0, "quiet"))[2]  # the jerkiest
    stiffness = 4.0 * float(np.median(run["hook_load"] * run["wire_out"]))  # a swing of 2 rad/s
    swinging = on_a_soft_wire(run, crane, stiffness)
    told, untold = (
        closure(view_of(swinging, replace(crane, wire_stiffness=each)), model).score for each in (stiffness, np.nan)
    )
    assert told < 0.4 * untold
    assert first_contradiction(quick_check([swinging], replace(crane, wire_stiffness=stiffness), model)) is None
    heavy = replace(run, columns={**run.columns, "hook_load": 0.45 * run["hook_load"]})
    assert first_contradiction(quick_check([heavy], replace(crane, wire_stiffness=stiffness), model)) is not None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "flavour"), [WORLDS[0], *(pytest.param(*each, marks=pytest.mark.long) for each in WORLDS[1:])]
)
def test_the_first_cause_is_the_true_one(seed, flavour, tmp):
    crane, model = world(seed, flavour, tmp)
    plain = [columns_of(seed, flavour)[k] for k in SOME]
    wrong = []
    chosen = spoils(crane.max_displacement, crane.gear_ratio)[OF_WORLD[seed, flavour]]
    for each in chosen:
        spoilt = [each.apply(columns) if not each.needs or each.needs in columns else columns for columns in plain]
        found = first_contradiction(quick_check(runs_of(spoilt), crane, model))
        if found is None or found.cause != each.cause or found.channel not in each.channels:
            wrong.append((each.name, found.sentence if found else "nothing"))
    assert len(wrong) <= (1.0 - RIGHT) * len(chosen), wrong


def test_the_weight_of_the_wire_is_no_mistake(tmp):
    """Two hundred metres of wire are heavier than the load of 4 t at the hook, where the load cell weighs."""
    folder = tmp / "heavy_wire"
    write_set(folder, SETS["tare_wire"], SETS["tare_wire"].seed(34))
    crane, model = load_crane(str(folder / "crane.yaml")), load_model(str(folder / "model.yaml"))
    runs = [read_run(path) for path in sorted((folder / "runs").iterdir())[::3]]
    assert first_contradiction(quick_check(runs, crane, model)) is None
    unknown = replace(crane, wire_mass=0.0)  # nobody knows what it weighs: the runs are not this crane's
    assert first_contradiction(quick_check(runs, unknown, model)) is not None


def test_another_crane_is_named(tmp):
    crane, _ = world(0, rig.DRAWN, tmp)
    runs = runs_of(columns_of(0, rig.DRAWN))
    big = load_crane("crane_150t")
    found = first_contradiction(quick_check(runs, big, None, lambda: {**known_cranes(), crane.name: crane}))
    assert found is not None
    assert found.cause == "crane"
    assert crane.name in found.sentence


def test_another_crane_is_claimed_only_where_its_motors_are_those_of_the_log(tmp):
    crane, _ = world(0, rig.DRAWN, tmp)
    runs, largest = runs_of(columns_of(0, rig.DRAWN))[::4], crane.max_displacement
    shown = max(float(run[f"{g}.displacement"].max()) for run in runs for g in run.groups)
    wrong = replace(crane, drum=Drum(tuple(1e3 * radius for radius in crane.drum.layer_radii)))

    def said(of_other, of_own=2.0 * largest):
        other = replace(crane, name="other", max_displacement=of_other)
        return next(
            iter(quick_check(runs, replace(wrong, max_displacement=of_own), None, lambda: {"other": other}))
        ).sentence

    assert said(shown).startswith("these are runs of crane 'other'")
    assert "whose motors these are the log does not say" in said(1.5 * shown)
    assert "'other'" not in said(1.5 * shown, of_own=shown)  # fully swivelled motors of the crane file
    assert "'other'" not in said(0.8 * shown)  # motors that cannot go so far


@pytest.mark.parametrize("some", [slice(None), slice(1, 2)])
def test_a_negative_displacement_is_no_swap_of_ports(some, tmp):
    crane, model = world(0, rig.DRAWN, tmp)
    runs = runs_of(columns_of(0, rig.DRAWN))[:4]
    runs[some] = [
        replace(run, columns={k: -v if k == "main.displacement" else v for k, v in run.columns.items()})
        for run in runs[some]
    ]
    found = first_contradiction(quick_check(runs, crane, model))
    assert (found.cause, found.channel) == ("sign", "main.displacement")
    assert found.sentence.startswith("the sign of main.displacement is flipped: negative throughout")
    assert "swapped" not in found.sentence or len(runs[some]) < len(runs)


def test_one_bad_run_among_good_ones_is_pointed_at(tmp):
    crane, model = world(1, "rough", tmp)
    runs = runs_of(columns_of(1, "rough"))
    runs[2] = replace(runs[2], columns={**runs[2].columns, "hook_load": 1e3 * runs[2]["hook_load"]})
    found = first_contradiction(quick_check(runs, crane, model))
    assert found is not None
    assert (found.cause, found.channel, found.runs) == ("unit", "hook_load", ("run_03",))


def test_what_a_recording_says_of_its_crane_is_believed(tmp):
    crane, model = world(1, "rough", tmp)
    run = replace(runs_of(columns_of(1, "rough"))[0], metadata={"crane": "emps"})
    found = first_contradiction(quick_check([run], crane, model))
    assert found is not None
    assert "emps" in found.sentence


def test_a_clock_that_jumps_is_an_error_and_a_slow_one_a_warning(tmp):
    crane, model = world(1, "rough", tmp)
    run = runs_of(columns_of(1, "rough"))[0]
    time = run.time.copy()
    time[-1] = 1e30
    found = quick_check([replace(run, columns={**run.columns, "time": time})], crane, model)
    assert [each.cause for each in found if each.contradicts] == ["clock"]
    slow = {name: values[::25] for name, values in run.columns.items()}
    assert "rate" in [each.cause for each in quick_check([Run("slow", slow)], crane, model)]


@pytest.mark.parametrize("origin", [0.0, 1743911276.0])
def test_a_time_in_ms_is_named(origin, tmp):
    crane, model = world(1, "rough", tmp)
    run = runs_of(columns_of(1, "rough"))[0]
    in_ms = replace(run, columns={**run.columns, "time": 1e3 * (run.time - run.time[0] + origin)})
    result = check([in_ms], crane, model)
    assert "time holds ms under [s]" in result.sentence
    assert [(each.cause, each.channel) for each in quick_check([in_ms], crane) if each.contradicts] == [
        ("unit", "time")
    ]


def test_the_whole_check_says_what_the_runs_teach_and_what_is_missing(tmp):
    crane, model = world(1, "rough", tmp)
    runs = [
        Run(each.name, {name: v for name, v in each.columns.items() if name != "oil_temperature"})
        for each in runs_of(columns_of(1, "rough"))
    ]
    result = check(runs, crane, model)
    assert result.plausible
    assert {each.name for each in result.identifiable} == set(model.parameter_names)
    assert all(each.after <= each.before * 1.0001 for each in result.identifiable)
    assert any(each.words == "much" for each in result.identifiable)
    assert any("oil_temperature" in line for line in result.log_next)
    content = result.content()
    assert set(content["channels"]) == {run.name for run in runs}
    assert np.isfinite([each["score"] for each in content["balance"]]).all()


def test_no_test_is_asked_for_beyond_what_the_crane_may_lift_and_turn(crane_150t, crane2_model):
    """Nine tenths of what the motors hold are 190 t on a crane that is rated at 150."""
    run = read_run(PRACTICE / "test_02.parquet")

    def asked(crane):
        words = [line.split() for line in check([run], crane, crane2_model).log_next if line.startswith("constant")]
        return [(float(each[each.index("t") - 1]), float(each[1])) for each in words]

    assert max(load for load, _ in asked(crane_150t)) <= 150.0
    assert max(load for load, _ in asked(replace(crane_150t, rated_load=0.0))) > 150.0
    slow = asked(replace(crane_150t, rated_speed=1500.0 * np.pi / 30.0))
    assert slow
    assert max(speed for _, speed in slow) <= 1500.0


PAIRS = (
    ("kg under [t]", "speed sign"), ("kN under [t]", "ports"), ("psi under [bar]", "ports"),
    ("MPa under [bar]", "ports"),
    ("rad/s under [rpm]", "speed sign"), ("drum's speed", "ports"), ("fraction under [cm^3/rev]", "ports"),
    ("cm^3/rev read per radian", "speed sign"), ("kg under [t]", "psi under [bar]"), ("speed sign", "ports"),
)  # fmt: skip


@pytest.mark.parametrize("names", PAIRS, ids="+".join)
def test_two_mistakes_at_once_are_both_named_before_any_other(crane_150t, names):
    run = read_run(PRACTICE / "test_02.parquet")
    made = {each.name: each for each in spoils(crane_150t.max_displacement, crane_150t.gear_ratio)}
    columns = {name: run[name] for name in run.columns}
    for name in names:
        columns = made[name].apply(columns)
    found = first_contradiction(quick_check([Run(run.name, columns)], crane_150t))
    assert found is not None
    assert found.cause == "two"
    assert all(made[name].channels[0] in found.channel for name in names), found.sentence


@pytest.mark.parametrize("falls", [2, 3])
def test_a_hook_in_several_falls_is_named_before_a_wrong_gear_or_load(crane_150t, falls):
    run = read_run(PRACTICE / "test_02.parquet")
    single = replace(crane_150t, drum=Drum(tuple(falls * radius for radius in crane_150t.drum.layer_radii)))
    found = first_contradiction(quick_check([run], single, None, dict))
    assert found.cause == "falls"
    assert f"in {falls} falls" in found.sentence
    assert f"divide layer_radii by {falls}" in found.sentence


def test_a_balance_that_is_open_both_ways_is_no_two_units(tmp):
    """A winch that jerks: with load and pressures a tenth of themselves its misfit is a tenth, and proves nothing."""
    crane, model = world(0, rig.DRAWN, tmp)
    jerked = []
    for run in runs_of(columns_of(0, rig.DRAWN))[::4]:
        waves = 1.0 + 0.6 * np.sign(np.sin(0.7 * (run.time - run.time[0])))
        jerked.append(replace(run, columns=times_drop(run.columns, waves)))
    said = first_contradiction(quick_check(jerked, crane, model))
    assert said is not None
    assert "under [MPa]" not in str(said)
    assert "two mistakes" not in str(said)


def times_drop(columns, factor):
    """Each group's pressures with another drop between them, the lower one as it was."""
    found = dict(columns)
    for name in columns:
        if name.endswith("pressure_a"):
            a, b = columns[name], columns[name[:-1] + "b"]
            found[name] = b + factor * (a - b)
    return found


def test_other_cranes_are_asked_for_only_where_runs_are_doubted_or_name_one(tmp):
    """Every call of `gap`, `identify` and `replay` read the files of all of them, though no run was doubted."""
    crane, model = world(0, rig.DRAWN, tmp)
    runs, asked = runs_of(columns_of(0, rig.DRAWN))[::4], []

    def others():
        asked.append(1)
        return known_cranes()

    assert first_contradiction(quick_check(runs, crane, model, others)) is None
    assert not asked
    named = [replace(run, metadata={"crane": "crane_150t"}) for run in runs]
    assert first_contradiction(quick_check(named, crane, model, others)).cause == "crane"
    assert len(asked) == 1
    assert quick_check(runs, replace(crane, gear_ratio=3.0 * crane.gear_ratio), model, others)
    assert len(asked) == 2


def test_mistakes_are_ranked_only_where_one_could_be_named_or_the_page_shows_them(tmp):
    crane, model = world(0, rig.DRAWN, tmp)
    runs = runs_of(columns_of(0, rig.DRAWN))[::4]
    assert not isinstance(diagnosed(runs, crane, model, dict)[1], Diagnosis)
    whole = check(runs, crane, model, dict).diagnosis
    assert whole.hypotheses
    assert whole.best is None


def test_a_mistake_is_named_where_each_run_by_itself_would_pass(tmp):
    crane, model = world(0, rig.DRAWN, tmp)
    columns = [{**each, "speed_reference": 2.0 * each["speed_reference"]} for each in columns_of(0, rig.DRAWN)[-4:]]
    findings, diagnosis = diagnosed(runs_of(columns), crane, model, dict)
    assert not diagnosis.contradicting
    assert [(each.cause, each.channel) for each in findings] == [("companion", "speed_reference")]


def test_a_transmitter_that_hangs_and_lost_telegrams_are_told(tmp):
    """`gap` leaves them out; who checks a log before is told, once for each channel, and the log stays plausible."""
    crane, model = world(0, rig.DRAWN, tmp)
    columns = dict(columns_of(0, rig.DRAWN)[8])
    rng = np.random.default_rng(1)
    for port in "ab":  # finer than this crane's transducers
        columns[f"active.pressure_{port}"] = columns[f"active.pressure_{port}"] + 1e4 * rng.standard_normal(
            len(columns["time"])
        )
    columns["active.pressure_a"][300:400] = columns["active.pressure_a"][300]
    columns["active.pressure_b"][700] = 0.0
    result = check([Run("run", columns)], crane, model, dict)
    assert result.plausible
    assert [(each.severity, each.sentence) for each in result.findings if each.channel.startswith("active.p")] == [
        ("warning", "run: active.pressure_a stands still for 3.96 s: nobody measured that"),
        ("warning", "run: active.pressure_b jumps in 1 single sample: nobody measured that"),
    ]
