"""Checkpoints survive what happens to machines: a killed writer, a broken file, another crane's file."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.estimation.checkpoint import Kept, filter_state, restored_state
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.crane import Drive, Drum
from winch_friction.records.checkpoint import LARGEST, SCHEMA, read_checkpoint, set_aside, write_checkpoint
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model, save_model

KILLS = 12
FUZZ = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
WRITER = """
import sys
from winch_friction.records.checkpoint import write_checkpoint
number = int(sys.argv[2])
while True:
    number += 1
    write_checkpoint(sys.argv[1], {"number": number, "filling": [float(number)] * 4000})
    print("written", flush=True)
"""


def samples(count=200):
    for k in range(count):
        speed = 100.0 * np.sin(0.02 * k)
        group = GroupSample(1.5e7 + 2e6 * np.tanh(speed), 2.5e6, 3.4e-5)
        yield Sample(0.02 * k, float(speed), groups={"main": group}, hook_load=55e3)


@pytest.fixture(scope="module")
def learned():
    estimator = FrictionEstimator(load_crane("crane_150t"), load_model("a6vm215_crane2"), EstimatorConfig())
    for sample in samples():
        estimator.step(sample)
    return estimator


def fresh(crane="crane_150t", model="a6vm215_crane2"):
    return FrictionEstimator(load_crane(crane), load_model(model), EstimatorConfig())


def test_what_was_learned_comes_back(tmp_path, learned):
    path = write_checkpoint(tmp_path / "c.json", learned.snapshot())
    again = fresh()
    again.restore(read_checkpoint(path))
    assert again.model().values == pytest.approx(learned.model().values, rel=1e-9)
    np.testing.assert_allclose(again.model().covariance, learned.model().covariance, rtol=1e-9, atol=1e-300)


def test_nothing_of_what_was_kept_is_lost_on_its_way(tmp_path, learned):
    """The load that hangs there, how far each parameter may be believed, and whose sigma was taken back."""
    content = learned.snapshot()
    names, count = learned.model().parameter_names, len(content["levels"])
    content |= {"levels": ["learned", *["learning"] * (count - 1)], "widened": [names[1], names[-1]]}
    again = fresh()
    again.restore(read_checkpoint(write_checkpoint(tmp_path / "c.json", content)))
    back = again.snapshot()
    assert back["mass"] == pytest.approx(55e3)
    assert {each.name for each in again.parameters() if each.prior_std > 1.001 * each.seed_std} == {names[1], names[-1]}
    for key in ("state", "covariance", "sensitivity"):
        np.testing.assert_allclose(back.pop(key), content.pop(key), rtol=1e-9, atol=1e-12)
    assert back == content


def test_no_file_yet_is_no_error(tmp_path):
    assert read_checkpoint(tmp_path / "none.json") is None


def test_another_cranes_or_seeds_checkpoint_is_refused_and_changes_nothing(tmp_path, learned):
    path = write_checkpoint(tmp_path / "c.json", learned.snapshot())
    for other in (fresh(model="a6vm215_crane1"), fresh(model="a6vm215")):
        before = other.model().values
        with pytest.raises(InputError):
            other.restore(read_checkpoint(path))
        assert other.model().values == before
        assert np.isfinite([other.step(sample).drum_torque for sample in samples(5)]).all()


@pytest.mark.slow
def test_a_writer_killed_at_any_moment_leaves_a_whole_checkpoint(tmp_path):
    path, number, rng = tmp_path / "c.json", 0, np.random.default_rng(0)
    for _ in range(KILLS):
        with subprocess.Popen(
            [sys.executable, "-c", WRITER, str(path), str(number)], stdout=subprocess.PIPE, text=True
        ) as writer:
            writer.stdout.readline()  # a busy machine may take as long for the first as the rest has
            time.sleep(0.02 + 0.06 * rng.random())
            os.kill(writer.pid, signal.SIGKILL)
        snapshot = read_checkpoint(path)
        assert snapshot is not None
        assert snapshot["filling"] == [float(snapshot["number"])] * 4000
        assert snapshot["number"] >= number
        number = snapshot["number"]
    assert number > KILLS


@FUZZ
@given(cut=st.integers(0, 10_000), byte=st.integers(0, 255), mode=st.sampled_from(["truncate", "flip", "garbage"]))
def test_a_damaged_checkpoint_is_refused_or_whole(tmp_path, learned, cut, byte, mode):
    path = write_checkpoint(tmp_path / "c.json", learned.snapshot())
    content = path.read_bytes()
    at = cut % len(content)
    damaged = {
        "truncate": content[:at],
        "flip": content[:at] + bytes([byte]) + content[at + 1 :],
        "garbage": bytes([byte]) * at,
    }[mode]
    path.write_bytes(damaged)
    estimator = fresh()
    said = restored(estimator, path)
    values = estimator.seed.values if said else learned.model().values
    assert estimator.model().values == pytest.approx(values, rel=1e-9)
    assert "\n" not in said
    assert np.isfinite([estimator.step(sample).drum_torque for sample in samples(5)]).all()


def restored(estimator, path):
    """Restore as the node does; what it says when it starts from the seed instead."""
    try:
        estimator.restore(read_checkpoint(path))
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    "content",
    [
        [],
        {"schema": "winch_friction.checkpoint/0", "snapshot": {}},
        {"schema": SCHEMA, "snapshot": {}},
        {"schema": SCHEMA, "snapshot": 3},
        None,
    ],
)
def test_other_json_is_refused(tmp_path, content):
    path = tmp_path / "c.json"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match="not a checkpoint"):
        read_checkpoint(path)


def test_what_was_refused_is_set_aside_and_nothing_there_is_replaced(tmp_path, learned):
    path, kept = tmp_path / "c.json", []
    for content in ("one", "two", "three"):
        path.write_text(content)
        kept.append(set_aside(path))
        write_checkpoint(path, learned.snapshot())
    assert [each.read_text() for each in kept] == ["one", "two", "three"]
    assert kept[0].name == "c.json.refused"
    with pytest.raises(InputError, match="not a file"):
        set_aside(tmp_path)


def test_a_model_given_as_the_checkpoint_stays_where_it_is(tmp_path, crane2_model):
    path = save_model(crane2_model, tmp_path / "m.yaml")
    before = path.read_text()
    with pytest.raises(InputError, match=r"m.yaml: a file of schema 'winch_friction.model/\d', not a checkpoint"):
        set_aside(path)
    assert path.read_text() == before


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda crane, seed: (replace(crane, gear_ratio=2.0 * crane.gear_ratio), seed), "gear_ratio"),
        (lambda crane, seed: (replace(crane, inertia=2.0 * crane.inertia), seed), "inertia"),
        (lambda crane, seed: (replace(crane, drum=Drum((0.5, 0.6))), seed), "layer_radii"),
        (lambda crane, seed: (crane, replace(seed, covariance=4.0 * seed.covariance)), "seed_std"),
    ],
)
def test_what_was_learned_with_another_machine_or_prior_of_the_same_name_is_not_taken_over(learned, change, what):
    """A gear ratio that was put right left the friction that had been learned with the wrong one, surely known."""
    other = FrictionEstimator(*change(load_crane("crane_150t"), load_model("a6vm215_crane2")), EstimatorConfig())
    with pytest.raises(InputError, match=f"checkpoint: {what} is"):
        other.restore(learned.snapshot())


@pytest.mark.parametrize("mass", [float("inf"), -5.0e4])
def test_a_mass_that_no_hook_carries_is_no_state(learned, mass):
    with pytest.raises(InputError, match="not those of a filter"):
        fresh().restore({**learned.snapshot(), "mass": mass})


def test_a_refused_file_that_cannot_be_renamed_stays_where_it_is(tmp_path):
    """On a disk that is read-only the estimator did not start at all, for what it had written itself."""
    path = tmp_path / f"{'c' * 245}.json"  # as long as a name may be
    path.write_text("{damaged")
    assert set_aside(path) == path
    assert path.read_text() == "{damaged"
    with pytest.raises(OSError, match="too long"):
        write_checkpoint(path, {"number": 1})


def test_a_pipe_is_no_checkpoint_and_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.json")
    with pytest.raises(InputError, match="nor a file at all"):
        read_checkpoint(tmp_path / "pipe.json")


def test_a_recording_given_as_the_checkpoint_is_not_read_into_memory(tmp_path):
    """3 GB were: a MemoryError and its traceback on a small computer."""
    path = tmp_path / "log.mcap"
    with path.open("wb") as stream:
        stream.truncate(LARGEST + 1)  # no disk is taken
    with pytest.raises(InputError, match="log.mcap: not a checkpoint: 16 MB; name another file"):
        read_checkpoint(path)


# -- what a checkpoint belongs to, and what is no state
OTHER = {
    "crane": {"name": "another"}, "drive": {"drive": Drive("electric")}, "gear_ratio": {"gear_ratio": 251.0},
    "inertia": {"inertia": 1.6}, "layer_radii": {"drum": Drum((0.8, 0.9))}, "groups": {"groups": {"main": 10}},
    "max_displacement": {"max_displacement": 3e-5},
}  # fmt: skip
MANY = 2


def kept_content():
    seed = load_model("a6vm215_crane2").subset(["motor_viscous", "stribeck"])
    size = MANY + len(seed.values)
    x = np.arange(float(size))[:, None]
    covariance = np.diag(1.0 + np.arange(float(size)))
    covariance[0, 1] = covariance[1, 0] = 0.5
    kept = Kept(x, covariance, np.full((1, size), 3.0), 55e3, ["seed"] * len(seed.values), [seed.parameter_names[0]])
    return load_crane("crane_150t"), seed, kept, size


@pytest.mark.parametrize("name", OTHER)
def test_a_checkpoint_of_a_crane_that_differs_in_any_of_this_is_refused_by_its_name(name):
    crane, seed, kept, size = kept_content()
    content = filter_state(crane, seed, kept)
    assert restored_state(content, crane, seed, size, 1).mass == 55e3
    with pytest.raises(InputError, match=f"checkpoint: {name} is "):
        restored_state(content, replace(crane, **OTHER[name]), seed, size, 1)


def test_what_is_kept_comes_back_field_by_field_and_even():
    crane, seed, kept, size = kept_content()
    content = filter_state(crane, seed, kept)
    content["covariance"][0][1] += 2e-3  # what rounding leaves between the halves
    found = restored_state(content, crane, seed, size, 1)
    assert found.x == pytest.approx(kept.x)
    assert found.sensitivity == pytest.approx(kept.sensitivity)
    assert found.covariance[0, 1] == found.covariance[1, 0] == pytest.approx(0.501)
    assert (found.levels, found.widened) == (kept.levels, kept.widened)
    assert np.isnan(
        restored_state(filter_state(crane, seed, replace(kept, mass=float("nan"))), crane, seed, size, 1).mass
    )


@pytest.mark.parametrize(
    "spoil",
    [{"levels": ["seed"]}, {"levels": ["seed"] * 9}, {"widened": ["no such"]}, {"mass": -1.0}, {"mass": float("inf")},
     {"state": [float("nan")] * 4}, {"sensitivity": [[float("inf")] * 4]}, {"covariance": (-np.eye(4)).tolist()}],
)  # fmt: skip
def test_numbers_that_are_no_state_are_refused(spoil):
    crane, seed, kept, size = kept_content()
    fitted = {key: _of_size(value, size) for key, value in spoil.items()}
    with pytest.raises(InputError, match="not those of a filter"):
        restored_state({**filter_state(crane, seed, kept), **fitted}, crane, seed, size, 1)


def _of_size(value, size):
    if not isinstance(value, list) or isinstance(value[0], str):
        return value
    if not isinstance(value[0], list):
        return [value[0]] * size
    return (-np.eye(size)).tolist() if len(value) > 1 else [[value[0][0]] * size]


@pytest.mark.parametrize(("share", "sound"), [(0.999, True), (1.0 + 1e-8, True), (1.001, False), (1.5, False)])
@pytest.mark.parametrize("unit", [1.0, 1e-9])
def test_two_states_are_correlated_by_one_at_most_whatever_their_unit(share, sound, unit):
    """But for rounding."""
    crane, seed, kept, size = kept_content()
    covariance = np.eye(size)
    covariance[1, 1] = unit**2
    covariance[0, 1] = covariance[1, 0] = share * unit
    content = filter_state(crane, seed, replace(kept, covariance=covariance))
    if sound:
        assert restored_state(content, crane, seed, size, 1).covariance == pytest.approx(covariance)
    else:
        with pytest.raises(InputError, match="not those of a filter"):
            restored_state(content, crane, seed, size, 1)


def test_what_is_kept_can_be_written_whatever_is_not_known():
    crane, seed, kept, _ = kept_content()
    content = filter_state(crane, seed, replace(kept, mass=float("nan")))
    assert json.loads(json.dumps(content, allow_nan=False))["mass"] is None
    assert filter_state(crane, seed, kept)["mass"] == 55e3


@pytest.mark.parametrize("key", ["version", "terms", "seed", "seed_values", "seed_std", "groups", "layer_radii"])
def test_a_state_is_refused_by_what_it_does_not_say_of_its_crane_and_seed(key):
    crane, seed, kept, size = kept_content()
    content = filter_state(crane, seed, kept)
    assert key in content
    del content[key]
    with pytest.raises(InputError, match=f"checkpoint: {key} is None, but this estimator has "):
        restored_state(content, crane, seed, size, 1)
