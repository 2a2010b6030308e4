"""A model whose file does not state the gear ratio is on its crane what one is that does."""

from dataclasses import replace

import numpy as np
import pytest

import winch_friction as wf
from winch_friction.compensation.compensator import FeedforwardCompensator
from winch_friction.estimation.estimator import FrictionEstimator
from winch_friction.physics.friction import term_named
from winch_friction.physics.friction.model import completed
from winch_friction.records.model_file import model_from_text, model_to_text
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate


@pytest.fixture
def stated(crane2_model):
    """A model with rolling sheaves, which lose a share of the load's torque over the gear ratio."""
    terms, values = (*crane2_model.terms, term_named("sheave_bending")), (*crane2_model.values, 0.03)
    std = np.append(crane2_model.std, 0.01)
    whole = replace(crane2_model, terms=terms, values=values, covariance=np.diag(std**2))
    return completed(whole, wf.load_crane("crane_150t"))


@pytest.fixture
def silent(stated):
    """The same without a word of it."""
    return replace(stated, constants={k: v for k, v in stated.constants.items() if k != "gear_ratio"})


def test_what_the_file_lacks_comes_from_the_crane(stated, silent, crane_150t):
    assert completed(silent, crane_150t).constants == stated.constants
    assert completed(stated, crane_150t) is stated
    # what the file says is not overruled: `refuse_other_crane` says that it is of another machine
    other = replace(stated, constants={**stated.constants, "gear_ratio": 3.0})
    assert completed(other, crane_150t).constants["gear_ratio"] == 3.0
    assert model_from_text(model_to_text(completed(silent, crane_150t))).constants == stated.constants


def test_nothing_else_changes_and_an_electric_winch_has_no_displacement(silent, crane_150t):
    thick = replace(silent, constants={**silent.constants, "density": 905.0})
    assert completed(thick, crane_150t).constants["density"] == 905.0
    drive = wf.load_crane("emps")
    assert completed(replace(silent, constants={}), drive).constants == {"gear_ratio": drive.gear_ratio}


@pytest.fixture(scope="module")
def run():
    return wf.simulate("ahc_55t_215", wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2"), duration=3.0).run


def test_every_reader_takes_the_ratio_of_the_crane(stated, silent, crane_150t, run):
    for reader in (wf.torque, wf.jacobian):
        np.testing.assert_array_equal(reader(silent, run, crane_150t), reader(stated, run, crane_150t))
    assert wf.contributions(silent, run, crane_150t).equals(wf.contributions(stated, run, crane_150t))
    curves = [wf.friction_curve(model, crane_150t, load=55e3) for model in (silent, stated)]
    assert curves[0].equals(curves[1])


def test_the_nodes_laws_take_the_ratio_of_the_crane(stated, silent, crane_150t, run):
    def published(model, then=None):
        compensator = FeedforwardCompensator(crane_150t, model)
        if then is not None:
            compensator.load_model(then)
        return [compensator.step(sample).friction_torque for sample in run.samples()]

    def learned(model):
        estimator = FrictionEstimator(crane_150t, model)
        for sample in run.samples():
            estimator.step(sample)
        return estimator.model().values

    assert published(silent) == published(stated)
    assert published(stated, silent) == published(stated, stated)
    assert max(map(abs, published(stated))) > 100.0  # N m
    assert learned(silent) == learned(stated)


def test_a_plant_turns_with_the_ratio_of_the_crane(stated, silent, crane_150t):
    scenario = load_scenario("ahc_55t_215").override({"duration": 1.0})
    runs = [simulate(scenario, crane_150t, model).run for model in (silent, stated)]
    np.testing.assert_array_equal(runs[0]["motor_speed"], runs[1]["motor_speed"])
