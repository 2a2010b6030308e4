"""What `init` writes for the crane that its rules scale is that crane's own; for others it goes as the rules say."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from winch_friction.cli import init
from winch_friction.cli.init_crane import CraneFacts, crane_text
from winch_friction.cli.init_texts import map_text, model_text, plant_text, scenario_text
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model, model_from_content
from winch_friction.simulation.plant_file import PlantFile, load_plant
from winch_friction.simulation.quantities import validated
from winch_friction.simulation.scenario import scenario_from_content


@pytest.fixture(scope="module")
def crane():
    return load_crane("crane_150t")


def plant_of(crane):
    return validated(PlantFile, yaml.safe_load(plant_text(crane, "p")), "p")


def flat(plant):
    named = {}
    for name, value in plant.dict().items():
        named |= {f"{name}.{key}": each for key, each in value.items()} if isinstance(value, dict) else {name: value}
    return {name: value for name, value in named.items() if isinstance(value, float)}


def test_the_plant_of_the_crane_that_is_scaled_is_its_own(crane):
    assert flat(plant_of(crane)) == pytest.approx(flat(load_plant("winch_150t")), rel=1e-3)


@pytest.mark.parametrize(
    ("change", "grows"),
    [
        (lambda c: {"max_displacement": 0.5 * c.max_displacement},
         {"pump.flow": 0.5, "active_loop.volume": 0.5, "active_loop.valve_gain": 0.5, "accumulator.gas_volume": 0.5,
          "leakage": 0.5, "case_leakage": 0.5}),
        (lambda c: {"groups": {"main": 22, "active": 6, "passive": 16}},
         {"pump.flow": 2.0, "active_loop.volume": 2.0, "active_loop.valve_gain": 2.0, "accumulator.gas_volume": 2.0}),
        (lambda c: {"groups": {"main": 11, "active": 9, "passive": 2}}, {"accumulator.gas_volume": 0.25}),
        (lambda c: {"groups": {"main": 22}}, dict.fromkeys(
            ("pump.flow", "active_loop.volume", "active_loop.valve_gain", "accumulator.gas_volume"), 2.0)),
        (lambda c: {"wire_stiffness": 3.0 * c.wire_stiffness}, {"wire_damping": 3.0}),
        (lambda c: {"wire_stiffness": float("inf")}, {}),
        (lambda c: {"gear_ratio": 2.0 * c.gear_ratio}, {}),
    ],
)  # fmt: skip
def test_another_cranes_plant_goes_with_its_motors_and_its_wire(change, grows, crane):
    own, other = flat(plant_of(crane)), flat(plant_of(replace(crane, **change(crane))))
    assert {name: other[name] / own[name] for name in own if other[name] != own[name]} == pytest.approx(grows, rel=1e-2)


def model_of(crane):
    return model_from_content(yaml.safe_load(model_text(crane, "m")), "m")


def test_the_model_of_the_crane_that_is_scaled_is_paper_2s(crane):
    found, own = model_of(crane), load_model("a6vm215_crane2")
    assert found.values == pytest.approx(own.values, rel=1e-3)
    assert found.std == pytest.approx(0.3 * np.array(own.values), rel=1e-2)
    assert found.constants["gear_ratio"] == crane.gear_ratio
    assert found.constants["max_displacement"] == pytest.approx(crane.max_displacement, rel=1e-5)


def test_a_model_goes_with_its_motors_size_and_with_its_share_of_the_drums_torque(crane):
    own = model_of(crane)

    def grown(**change):
        other = model_of(replace(crane, **change))
        ratios = {name: other.value(name) / own.value(name) for name in own.parameter_names if own.value(name)}
        return {name: ratio for name, ratio in ratios.items() if abs(ratio - 1.0) > 1e-3}, other

    by_size, other = grown(max_displacement=2.0 * crane.max_displacement)
    expected = {"K1": 2.0, "K2": 2.0 ** (-4 / 3), "K4": 2.0, "K5": 2.0, "C3": 2.0, "C5": 2.0}
    assert by_size == pytest.approx({name: each for name, each in expected.items() if name in by_size}, rel=1e-3)
    assert {"K1", "K2", "K4", "C3", "C5"} <= set(by_size)
    assert other.constants["max_displacement"] == pytest.approx(2.0 * crane.max_displacement, rel=1e-5)
    by_gear, other = grown(gear_ratio=0.5 * crane.gear_ratio)
    assert by_gear == pytest.approx({"C1": 2.0, "C6": 2.0}, rel=1e-3)
    assert other.constants["gear_ratio"] == 0.5 * crane.gear_ratio
    assert grown(groups={"main": 22, "active": 3, "passive": 8})[0] == pytest.approx({"C1": 0.5, "C6": 0.5}, rel=1e-3)


def test_a_scenario_hangs_a_third_of_what_the_motors_hold_on_the_outermost_layer(crane):
    def scenario(mode, load=None):
        return scenario_from_content(yaml.safe_load(scenario_text(crane, "s", "own_plant", mode, load)))

    sea, cycle = scenario("ahc"), scenario("normal", 7.0)
    holds = 11 * crane.max_displacement * 275e5 * crane.gear_ratio / (GRAVITY * max(crane.drum.layer_radii))
    assert sea.load == pytest.approx(holds / 3.0, rel=5e-3)
    assert cycle.load == pytest.approx(7000.0)
    assert (sea.plant, sea.crane, sea.wire_layer, sea.wire_out) == ("own_plant", "crane_150t", 6, 50.0)
    assert sea.displacement == pytest.approx(crane.max_displacement, rel=1e-3)
    assert (sea.duration, cycle.duration, sea.sensors.rate) == (240.0, 120.0, 50.0)
    assert (sea.sea.kind, sea.sea.amplitude, sea.sea.period) == ("regular", 1.0, 10.0)
    assert cycle.profile.pump_shares == (0.02, 0.05, 0.1, 0.25, 0.5, 0.9)
    assert (cycle.profile.hold, cycle.profile.ramp, cycle.profile.rest) == (6.5, 1.5, 1.5)


def columns_of(crane):
    content = yaml.safe_load(map_text(crane))
    return content, {name: entry["unit"] for name, entry in content["columns"].items()}


def test_a_map_to_fill_in_has_the_units_that_logs_have(crane):
    group = {"pressure_a": "bar", "pressure_b": "bar", "displacement": "cm^3/rev"}
    common = {"motor_speed": "rpm", "hook_load": "t"}
    content, units = columns_of(crane)
    assert units == {**common, **{f"{g}.{c}": u for g in crane.groups for c, u in group.items()}}
    assert (content["crane"], content["time"]) == ("crane_150t", {"from": ["COLUMN"], "form": "seconds", "unit": "s"})
    content, units = columns_of(None)
    assert units == {**common, **{f"main.{c}": u for c, u in group.items()}}
    assert "crane" not in content
    for kind, (channel, unit) in {"electric": ("motor_torque", "N*m"), "power": ("mechanical_power", "kW"),
                                  "current": ("motor_current", "A")}.items():  # fmt: skip
        other = SimpleNamespace(name="ours", drive=SimpleNamespace(kind=kind, hydraulic=False))
        assert columns_of(other)[1] == {**common, channel: unit}


# -- the verb
def test_names_that_nobody_gave_are_the_cranes(tmp_path, monkeypatch):
    written = {}
    monkeypatch.setattr(init, "_write_all", lambda texts, *_: written.update(texts))
    path = tmp_path / "file_of_mine.yaml"
    facts = CraneFacts(name="ours", load=50.0, motors=5, displacement=160.0, gear_ratio=180.0, radius=0.6, layers=5,
                       active=2, wire=44.0)  # fmt: skip
    path.write_text(crane_text(facts))
    init.plant(str(path))
    init.model(str(path))
    init.scenario(str(path), plant="", mode="ahc", load=None)
    init.scenario(str(path), plant="other.yaml", mode="normal", load=3.0)
    init.map_("")
    assert [str(each) for each in written] == [
        "plant_ours.yaml", "seed_ours.yaml", "ahc_ours.yaml", "normal_ours.yaml", "log_map.yaml",
    ]  # fmt: skip
    names = {str(path): yaml.safe_load(text).get("name") for path, text in written.items()}
    assert names == {"plant_ours.yaml": "plant_ours", "seed_ours.yaml": "seed_ours", "ahc_ours.yaml": "ahc_ours",
                     "normal_ours.yaml": "normal_ours", "log_map.yaml": None}  # fmt: skip
    plants = {name: yaml.safe_load(written[Path(name)])["plant"] for name in ("ahc_ours.yaml", "normal_ours.yaml")}
    assert plants == {"ahc_ours.yaml": "plant_ours.yaml", "normal_ours.yaml": "other.yaml"}
    assert yaml.safe_load(written[Path("normal_ours.yaml")])["load"] == {"value": 3.0, "unit": "t"}
    with pytest.raises(InputError, match="--mode calm: use normal or ahc"):
        init.scenario(str(path), plant="", mode="calm", load=None)


def test_a_crane_without_groups_for_the_sea_has_a_normal_scenario_alone(monkeypatch, crane):
    bare = replace(crane, groups={"main": 11})
    monkeypatch.setattr(init, "_hydraulic", lambda *_: bare)
    monkeypatch.setattr(init, "_write_all", lambda *_: None)
    init.scenario("crane", plant="", mode="normal", load=None)
    with pytest.raises(InputError, match="crane 'crane_150t' has no groups active and passive; use --mode normal"):
        init.scenario("crane", plant="", mode="ahc", load=None)


def test_one_file_that_exists_keeps_all_from_being_written(tmp_path, capsys):
    first, second = tmp_path / "a.yaml", tmp_path / "b.yaml"
    second.write_text("old")
    with pytest.raises(InputError, match="b.yaml: exists already"):
        init._write_all({first: "A", second: "B"}, False, False)
    assert not first.exists()
    init._write_all({first: "A", second: "B"}, True, False)
    assert (first.read_text(), second.read_text()) == ("A", "B")
    assert capsys.readouterr().out.splitlines() == [f"written: {first}", f"written: {second}"]
    for name in ("a/b", "../b", "/b", "b/"):
        with pytest.raises(InputError, match="a name without '/'"):
            init._file_of(name)


def test_who_sits_there_is_asked_in_words_for_what_lacks(monkeypatch):
    asked = {"load": (50.0, float, "rated load, t"), "layers": (None, int, "wire layers")}
    monkeypatch.setattr(init.sys.stdin, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(init.typer, "prompt", lambda words, type: (words, type))
    assert init._answered(asked) == {"load": 50.0, "layers": ("wire layers", int)}
    monkeypatch.setattr(init.sys.stdin, "isatty", lambda: False, raising=False)
    with pytest.raises(InputError, match=r"^init crane needs --layers \(wire layers\)$"):
        init._answered(asked)
