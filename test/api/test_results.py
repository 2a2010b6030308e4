"""What the jobs return in a notebook: words, rows and points of the very result behind them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import winch_friction as wf
from winch_friction.api.evaluate import _points
from winch_friction.api.results import Check, Fit, Gap, Replay
from winch_friction.estimation import ParameterEstimate
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.replay.recording import Replayed

CRANE, MODEL = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")


def replayed():
    """Ten seconds, active in three samples of four, with one parameter learned and one at its seed."""
    torque = np.array([0.0, 300.0, -400.0, 0.0])
    time = np.array([5.0, 8.0, 11.0, 15.0])
    fed = Run("c", {"time": time, "friction_torque": torque}, aside={"state": np.array(["off", *["active"] * 3])})
    own = Run(
        "e", {"time": time, "friction_torque": 2 * torque}, aside={"state": np.array(["rejected", *["taken"] * 3])}
    )
    estimates = (
        ParameterEstimate("C3", "N*m", value=1.25, std=0.5, seed_value=0.5, seed_std=1.0, status="frozen"),
        ParameterEstimate("C4", "rad/s", value=3.0, std=0.5, seed_value=3.0, seed_std=1.0, status="seed"),
    )
    return Replay(Replayed(fed, own, MODEL.with_values({"C3": 1.25}), estimates, {}), MODEL)


def test_a_replay_says_its_length_its_torque_and_what_was_learned_from_what():
    found = replayed()
    assert found.summary() == (
        "10 s, feedforward active 75% of the time, 250 N m RMS, 400 at most; learned: C3 0.5 -> 1.25 N*m"
    )
    assert (found.compensator.name, found.estimator.name) == ("c", "e")
    assert (found.model.value("C3"), found.seed.value("C3")) == (1.25, MODEL.value("C3"))
    rows = found.parameters
    assert rows.loc["C3", ["unit", "seed", "learned", "sigma", "status"]].tolist() == ["N*m", 0.5, 1.25, 0.5, "frozen"]
    assert rows.index.tolist() == ["C3", "C4"]


def test_a_fit_says_its_terms_parameters_and_error():
    assert Fit(MODEL.only("motor"), 1.2345, None).summary().endswith(": 5 parameters, RMS 1.23 N m per motor")


def test_a_check_has_a_row_for_each_finding_and_is_its_sentence():
    finding = SimpleNamespace(
        severity="error", sentence="wrong unit", content=lambda: {"severity": "error", "cause": "unit"}
    )
    found = Check(SimpleNamespace(plausible=False, findings=(finding,), sentence="not this crane's"))
    assert (found.plausible, found.summary(), repr(found)) == (False, "not this crane's", "Check: not this crane's")
    assert found.findings.to_dict("records") == [{"severity": "error", "cause": "unit"}]
    assert "wrong unit" in found._repr_html_()


def gap(**more):
    base = {
        "effects": [
            {
                "name": "coulomb",
                "indistinguishable_from": ["notch", "wear"],
                "parameters": {"T": {"value": 12.0, "std": 0.5, "unit": "N*m"}},
                "evidence": {"p_value": 0.01, "cv_gain": 0.5, "selection_frequency": 0.9, "where": "moving"},
            }
        ],
        "gap": {"unit": "bar", "holdout": {"before": 2.5, "after": 0.5, "noise_floor": 0.25}},
    }
    return Gap(SimpleNamespace(content=lambda: base | more, verdict="nothing_missing", effects=(), model=MODEL))


def test_a_gap_says_before_after_and_noise_and_has_a_row_for_each_effect():
    found = gap()
    assert found.summary().endswith("Gap on locked runs: 2.5 bar before, 0.5 after; noise 0.25 bar.")
    row = found.effects.loc["coulomb"]
    assert (row["indistinguishable_from"], row["parameters"]) == ("notch, wear", "T = 12 ± 0.5 N*m")
    assert (row["p_value"], row["cv_gain"], row["selection_frequency"]) == (0.01, 0.5, 0.9)
    none = gap(effects=[], gap={"unit": "bar", "holdout": {"before": None, "after": None, "noise_floor": None}})
    assert "locked runs" not in none.summary()
    assert none.effects.columns.tolist() == [
        "indistinguishable_from",
        "parameters",
        "p_value",
        "cv_gain",
        "selection_frequency",
    ]
    assert len(none.effects) == 0


def turning(**more):
    known = {"pressure_a": 2e7, "pressure_b": 2e6, "displacement": CRANE.max_displacement}
    groups = {f"main.{name}": np.full(3, value) for name, value in known.items()}
    return Run("r", {"time": np.arange(3.0), "motor_speed": np.array([60.0, 80.0, 100.0])} | groups | more)


def test_a_load_that_is_given_stands_for_the_column_that_is_not_there():
    logged = wf.torque(MODEL, turning(hook_load=np.full(3, 55e3)), CRANE)
    assert wf.torque(MODEL, turning(), CRANE, load=55e3) == pytest.approx(logged)
    assert wf.torque(MODEL, turning(), CRANE, load=0.0)[0] < logged[0]
    with pytest.raises(InputError, match="r: no column 'hook_load'; give load= in kg"):
        wf.torque(MODEL, turning(), CRANE)


def test_contributions_and_derivatives_are_those_of_the_same_torque():
    run = turning(hook_load=np.full(3, 55e3))
    torque = wf.torque(MODEL, run, CRANE)
    parts = wf.contributions(MODEL, run, CRANE)
    assert parts.sum(axis=1).to_numpy() == pytest.approx(torque)
    assert parts.index.tolist() == [0.0, 1.0, 2.0]
    assert set(parts.attrs["units"].values()) == {"s", "N*m"}
    k = MODEL.parameter_names.index("K4")
    more = MODEL.with_values({"K4": 1.01 * MODEL.value("K4")})
    change = (wf.torque(more, run, CRANE) - torque) / (0.01 * MODEL.value("K4"))
    assert wf.jacobian(MODEL, run, CRANE)[:, k] == pytest.approx(change, rel=1e-6)
    assert _points(MODEL, run, CRANE, None)[2].tolist() == [0.0, 1.0, 2.0]


def test_a_curve_is_in_si_at_the_speeds_load_and_displacement_that_were_asked_for():
    from winch_friction.physics.winch.model_curve import model_curve

    half = 0.5 * CRANE.max_displacement
    found = wf.friction_curve(MODEL, CRANE, load=55e3, displacement=half, speed=[20.0, 90.0])
    expected = model_curve(MODEL, CRANE, load=55e3, displacement=half, speed=[20.0, 90.0])
    assert found.index.tolist() == [20.0, 90.0]
    for name in ("torque", "std", "pressure"):
        assert found[name].to_numpy() == pytest.approx(getattr(expected, name))
    terms = found.drop(columns=["torque", "std", "pressure"])
    assert terms.sum(axis=1).to_numpy() == pytest.approx(expected.torque)
    assert (found.attrs["units"]["pressure"], found.attrs["units"]["std"], found.attrs["units"]["speed"]) == (
        "Pa",
        "N*m",
        "rad/s",
    )


def test_a_jobs_arguments_are_refused_before_the_work():
    with pytest.raises(InputError, match="motor= is the name of a motor-loss model"):
        wf.fit("a6vm215_generated", motor=MODEL)
    with pytest.raises(InputError, match="logged tests need a crane"):
        wf.fit([turning()])


def test_options_of_gap_and_check_reach_the_work(monkeypatch):
    from winch_friction.commissioning import commissioning
    from winch_friction.discrepancy import workflow

    asked = []
    monkeypatch.setattr(workflow, "find_gap", lambda *given: asked.append(given))
    monkeypatch.setattr(commissioning, "check", lambda *given: asked.append(given))
    run = turning()
    wf.gap([run], CRANE, MODEL, holdout=0.4, seed=7)
    wf.check([run], CRANE, MODEL)
    (runs, crane, model, options), checked = asked
    assert (runs, crane, model) == ([run], CRANE, MODEL)
    assert (options.holdout, options.seed) == (0.4, 7)
    assert checked == ([run], CRANE, MODEL)


# -- what is asked for reaches the work
def test_a_simulation_has_its_seed_its_hidden_effects_and_the_changes_of_its_scenario(monkeypatch):
    from winch_friction import simulation

    asked, plain = [], SimpleNamespace(override=lambda changes: ("changed", changes))
    monkeypatch.setattr(simulation, "load_scenario", lambda name: plain if name == "heave" else None)
    monkeypatch.setattr(simulation, "simulate", lambda *given: asked.append(given))
    wf.simulate("heave", CRANE, MODEL, seed=7, hidden={"churning": 2.0}, duration=9.0)
    wf.simulate("heave", CRANE, MODEL)
    assert asked == [
        (("changed", {"duration": 9.0}), CRANE, MODEL, 7, {"churning": 2.0}), (plain, CRANE, MODEL, 0, {}),
    ]  # fmt: skip


@pytest.mark.parametrize("learn", [True, False])
@pytest.mark.parametrize("params_file", [None, "nodes.yaml"])
def test_a_replay_learns_where_it_is_asked_to_by_the_settings_of_its_file(monkeypatch, learn, params_file):
    from winch_friction.records import input_mapping
    from winch_friction.replay import recording, settings

    asked = []
    monkeypatch.setattr(settings, "settings_from_file", lambda path, namespace: f"settings of {path} {namespace}")
    monkeypatch.setattr(input_mapping, "bag_options_of", lambda path, namespace: {"joints": f"of {path} {namespace}"})
    for name in ("replay_run", "replay_recording"):
        monkeypatch.setattr(recording, name, lambda *given, name=name, **more: asked.append((name, given, more)))
    named = "port" if params_file else ""  # of a run without a file, there is no winch to choose
    run, own = turning(), params_file and "settings of nodes.yaml port"
    for recorded in (run, "a.mcap"):
        result = wf.replay(recorded, CRANE, MODEL, learn=learn, params_file=params_file, namespace=named)
        assert result.seed is MODEL
    usual = settings.ReplaySettings()
    assert asked == [
        ("replay_run", (run, CRANE, MODEL, own or usual), {"learn": learn}),
        ("replay_recording", ("a.mcap", CRANE, MODEL, own), {"learn": learn, "joints": f"of {params_file} {named}"}),
    ]


def test_a_suppliers_table_is_fitted_by_the_model_that_is_named(monkeypatch):
    from winch_friction.identification import motor_identification, supplier_file

    asked = []
    monkeypatch.setattr(supplier_file, "read_supplier_table", lambda path: path.name)
    found = SimpleNamespace(chosen=SimpleNamespace(fitted=SimpleNamespace(rms=1.5)))
    monkeypatch.setattr(
        motor_identification, "identify_motor", lambda *given, **more: asked.append((given, more)) or found
    )
    monkeypatch.setattr(motor_identification, "motor_seed", lambda *given: given)
    result = wf.fit("a6vm215_generated", motor="thoma", seed=5)
    assert asked == [
        (("a6vm215_generated.csv", ["thoma"]), {"chosen": "thoma", "with_complex": False, "seed": 5}),
    ]  # fmt: skip
    assert (result.model, result.rms, result.details) == ((found, "a6vm215_generated", {}), 1.5, found)


def test_logged_tests_are_fitted_on_top_of_a_motor_alone_and_what_is_held_out_verifies(monkeypatch):
    from winch_friction.identification import system_identification, verification

    asked, found = [], SimpleNamespace(joint=SimpleNamespace(model="joint"), tests=[SimpleNamespace(curve="curve")])
    monkeypatch.setattr(
        system_identification, "identify_system", lambda *given, **more: asked.append((given, more)) or found
    )
    monkeypatch.setattr(system_identification, "winch_seed", lambda *given: given)
    errors = [(np.array([1.0, 4.0]), np.array([4.0, 8.0])), (np.zeros(3), np.full(3, 2.0))]  # squares 12.5 and 4
    monkeypatch.setattr(
        verification, "test_errors", lambda model, curves: [
            SimpleNamespace(modelled=a, measured=b) for a, b in errors if (model, curves) == ("joint", ["curve"])
        ],
    )  # fmt: skip
    tests, kept = [turning()], [turning(hook_load=np.zeros(3))]
    result = wf.fit(tests, CRANE, motor=MODEL, held_out=kept, seed=3)
    (((runs, crane, motor, _), more),) = asked
    assert (runs, crane, more) == (tests, CRANE, {"held_out": kept, "seed": 3})
    assert motor.term_names == MODEL.only("motor").term_names
    assert result.rms == pytest.approx(8.25**0.5)  # every test counts once, however long
    assert (result.model, result.details) == ((found, CRANE, "fitted", {}), found)


# -- runs from tables
def test_a_frames_units_are_those_beside_it_and_its_index_is_the_time():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(
        {"time [ms]": [0.0, 500.0, 1000.0], "drum_speed": [60.0, 0.0, -60.0], "motor_torque": [1.0, 2.0, 3.0],
         "mood": ["good", "bad", "good"]},
    ).set_index("time [ms]")  # fmt: skip
    frame.attrs["units"] = {"drum_speed": "rpm", "motor_torque": "kN*m", "mood": ""}
    crane = wf.load_crane("emps")
    run = wf.from_frame(frame, "ramp", crane)
    assert run.time.tolist() == [0.0, 0.5, 1.0]
    turns = 2.0 * np.pi * crane.gear_ratio
    assert run["motor_speed"] == pytest.approx([turns, 0.0, -turns])
    assert run["motor_torque"].tolist() == [1e3, 2e3, 3e3]
    assert run.aside["mood"].tolist() == ["good", "bad", "good"]
    assert any("unknown columns kept aside: mood" in each for each in run.warnings)
    with pytest.raises(InputError, match="gear ratio"):
        wf.from_frame(frame, "ramp")


def test_a_dataset_carries_the_unit_of_each_variable():
    xarray = pytest.importorskip("xarray")
    data = xarray.Dataset(
        {"motor_speed": ("time", [60.0, 120.0], {"units": "rpm"}), "motor_torque": ("time", [1.0, 2.0]),
         "oil_temperature": ("time", [104.0, 212.0], {"units": "degF"})},
        coords={"time": ("time", [0.0, 1500.0], {"units": "ms"})},
    )  # fmt: skip
    run = wf.from_frame(data, "set")
    assert (run.name, run.time.tolist()) == ("set", [0.0, 1.5])
    assert run["motor_speed"] == pytest.approx([2.0 * np.pi, 4.0 * np.pi])
    assert run["oil_temperature"] == pytest.approx([40.0, 100.0])
    assert run["motor_torque"].tolist() == [1.0, 2.0]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"motor_speed": ["fast", 1.0]}, "t: column 'motor_speed' holds something that is not a number"),
        ({"time": [1.0, 0.0]}, "t: row 1, column 'time': time goes back by 1 s"),
        ({"motor_torque [bar]": [1.0, 2.0]}, "t: column 'motor_torque .bar.': unit 'bar' cannot be read as N.m"),
    ],
)
def test_a_table_that_is_no_run_is_refused_with_row_and_column(change, said):
    columns = {"time": [0.0, 1.0], "motor_speed": [1.0, 2.0], "motor_torque": [1.0, 2.0]}
    if "motor_torque [bar]" in change:
        del columns["motor_torque"]
    with pytest.raises(InputError, match=said):
        wf.from_frame(columns | change, "t")


# -- in a notebook
def test_what_is_learned_is_shown_beside_its_sigma_and_only_what_is_being_learned():
    names = ("learning", "learned", "frozen", "seed", "unobservable")
    known = tuple(
        ParameterEstimate(f"P{k}", "1", value=-1e-9 if k == 1 else 2.0, std=0.5, seed_value=1.0, seed_std=1.0, status=s)
        for k, s in enumerate(names)
    )
    whole = Replay(replace(replayed().result, parameters=known), MODEL)
    assert whole.summary().endswith("learned: P0 1 -> 2 1, P1 1 -> 0 1, P2 1 -> 2 1")
    found = Replay(replace(replayed().result, parameters=known[3:]), MODEL)
    assert found.summary().endswith("learned: nothing beyond the seed")
    shown = found._repr_html_()
    assert "<th>parameter</th><th>unit</th><th>seed</th><th>learned</th><th>sigma</th><th>status</th>" in shown
    assert "<td>P3</td><td>1</td><td>1</td><td>2</td><td>0.5</td><td>seed</td>" in shown


def test_a_fit_and_a_gap_show_their_table():
    assert "<th>parameter</th>" in Fit(MODEL.only("motor"), 1.2345, None)._repr_html_()
    assert "<td>coulomb</td><td>notch, wear</td><td>T = 12 ± 0.5 N*m</td><td>0.01</td>" in gap()._repr_html_()
    assert (gap().verdict, gap().model) == ("nothing_missing", MODEL)
