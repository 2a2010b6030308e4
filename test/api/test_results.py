"""What the jobs return in a notebook: words, rows and points of the very result behind them."""

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
