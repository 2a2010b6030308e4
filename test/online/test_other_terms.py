"""Learned models of other terms than those that were given: of an estimator that was started on another model file."""

import dataclasses

import pytest
from sea import CRANE, SEED, TOPICS, Fed

from winch_friction.online.compensator import CompensatorService, refuse_other_terms
from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.correction import Correction
from winch_friction.records.model_file import load_model, model_from_text, model_to_text


@pytest.fixture
def fed() -> Fed:
    made = Fed()
    made.run(1.4)
    return made


def test_a_learned_model_without_the_winchs_own_terms_takes_nothing_away(fed: Fed) -> None:
    """Of an estimator on the motors' model: the feedforward fell by a third, and its state was 'active'."""
    motors = load_model("a6vm215")
    fed.service.offer(motors)
    fed.run(1.0)
    status = fed.service.status(fed.now)
    assert status["model"] == SEED.name
    assert "lacks gear_load_loss, stribeck, viscous" in status["learned_model_refused"]
    assert "start the estimator on the model_file of 'a6vm215_crane2'" in status["learned_model_refused"]
    assert fed.service.refused_models == [status["learned_model_refused"]]
    fed.service.offer(SEED.with_values({"C6": 1.1 * SEED.value("C6")}))
    fed.run(0.5)
    assert fed.service.status(fed.now)["learned_model_refused"] == ""
    assert fed.service.law.model.value("C6") == 1.1 * SEED.value("C6")


def test_a_repaired_model_that_was_loaded_is_not_undone_by_what_is_learned_of_the_one_before(fed: Fed) -> None:
    repaired = dataclasses.replace(SEED.subset([n for n in SEED.term_names if n != "viscous"]), name="repaired")
    assert fed.service.load_model(repaired) == "beside 'a6vm215_crane2' it lacks viscous"
    assert fed.service.load_model(repaired) == ""  # the same terms, however its numbers differ
    fed.run(0.5)
    fed.service.offer(SEED)
    fed.run(0.5)
    status = fed.service.status(fed.now)
    assert status["model"] == "repaired"
    assert "has besides viscous" in status["learned_model_refused"]
    fed.service.load_model(SEED)
    assert fed.service.status(fed.now)["learned_model_refused"] == ""
    fed.service.offer(SEED)
    fed.run(0.5)
    assert fed.service.status(fed.now)["learned_model_refused"] == ""


def test_other_corrections_are_another_model_as_well() -> None:
    offset = Correction("pressure_offset", 1.5e5)
    corrected = dataclasses.replace(SEED, corrections=(offset,))
    refuse_other_terms(dataclasses.replace(corrected, corrections=(dataclasses.replace(offset, value=1e5),)), corrected)
    with pytest.raises(InputError, match="lacks pressure_offset"):
        refuse_other_terms(SEED, corrected)
    with pytest.raises(InputError, match="has besides pressure_offset"):
        refuse_other_terms(corrected, SEED)


def test_what_an_estimator_learns_of_the_same_file_is_taken_over() -> None:
    corrected = dataclasses.replace(SEED, corrections=(Correction("pressure_offset", 1.5e5),))
    learned = EstimatorService(CRANE, corrected, TOPICS).law.model()
    service = CompensatorService(CRANE, corrected, TOPICS)
    refuse_other_terms(model_from_text(model_to_text(learned), "friction_model"), service.law.seed)
