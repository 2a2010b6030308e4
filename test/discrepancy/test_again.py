"""What is shipped is what is proven: the written model, read back, leaves nothing on the same and on fresh runs."""

from dataclasses import replace

import numpy as np
import pytest
from gap_rig import LENGTH, gap_of, runs_with

from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.expansion import meet
from winch_friction.discrepancy.proof import compare
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model, save_model

FRESH = 0.55  # of a campaign's length: the same plant and the same plan in another sea, with other noise
# terms, signals, states and the oil go other ways into the file: they are among MORE
CASES = [("tare_load", "quiet")]
MORE = [
    ("churning", "paper"), ("presliding", "quiet"),
    ("pressure_offset", "rough"),
    ("stribeck", "si_files"), ("inertia_error", "elastic_still"), ("swivel_offset", "quiet"),
    ("slip_leakage", "slow_log"), ("accumulator_thermal", "si_files"), ("torque_ripple", "rough"),
    ("entrained_air", "quiet"),
]  # fmt: skip
# the workflow once more over the same runs: in the others the written file is measured on them
SAME_AGAIN = tuple(effect for effect, _ in MORE[2:-1])


@pytest.mark.parametrize(
    ("effect", "flavour"),
    [
        *CASES,
        *(pytest.param(*each, marks=pytest.mark.long) for each in MORE),
    ],
)
def test_the_written_model_leaves_nothing(effect, flavour, tmp_path):
    crane, first_model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    first = gap_of(4050, flavour, (effect, 1.0))
    assert [effect in (each.name, *each.rivals) for each in first.effects] == [True]
    model = load_model(save_model(first.model, tmp_path / "model.yaml"))
    same = runs_with(4050, flavour, (effect, 1.0))
    names = [run.name for run in first.holdout.runs]
    side = compare(meet(same, crane, first_model), meet(same, crane, model), names, np.random.default_rng(0))
    # the same runs: what the first claimed is what the file itself leaves
    assert side.size_after.value == pytest.approx(first.holdout.size_after.value, rel=0.05)
    assert side.size_after.value <= 1.5 * side.noise_floor
    for length in (LENGTH, FRESH) if effect in SAME_AGAIN else (FRESH,):
        again = find_gap(runs_with(4050, flavour, (effect, 1.0), length=length), crane, model, GapOptions(plan=False))
        holdout = again.holdout
        assert again.verdict == "nothing_missing", (length, [each.name for each in again.effects])
        assert holdout.size_before.value <= 1.5 * holdout.noise_floor
        if length < FRESH:
            assert holdout.size_before.value == pytest.approx(first.holdout.size_after.value, rel=0.05)


def test_what_is_claimed_is_the_file_and_not_the_fit():
    """A correction that is lost on its way to the file must show in the claimed figure."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    result = gap_of(4050, "quiet", ("tare_load", 1.0))
    runs = runs_with(4050, "quiet", ("tare_load", 1.0))
    names = [run.name for run in result.holdout.runs]
    lost = replace(result.model, corrections=())
    side = compare(meet(runs, crane, model), meet(runs, crane, lost), names, np.random.default_rng(0))
    assert side.size_after.value > 10.0 * result.holdout.size_after.value
