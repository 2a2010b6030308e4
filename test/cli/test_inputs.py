"""Which files of a folder are runs."""

from dataclasses import replace

import pytest

from winch_friction.cli.inputs import machine_of, run_paths
from winch_friction.physics.errors import InputError, Problems
from winch_friction.records.model_file import load_model, model_to_text


def test_a_folders_runs_are_neither_truth_nor_hidden_files_nor_anything_else(tmp_path):
    for name in ("b.csv", "a.parquet", "a_truth.csv", ".c.csv", "notes.txt", "z.CSV"):
        (tmp_path / name).touch()
    assert [each.name for each in run_paths([tmp_path])] == ["a.parquet", "b.csv", "z.CSV"]


def test_a_folder_with_metadata_is_one_bag_and_a_file_is_taken_as_it_is_named(tmp_path):
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "metadata.yaml").touch()
    (bag / "bag_0.mcap").touch()
    assert run_paths([tmp_path, tmp_path / "x_truth.csv"]) == [bag, tmp_path / "x_truth.csv"]


def test_a_folder_without_runs_is_refused(tmp_path):
    with pytest.raises(InputError, match="no run in there"):
        run_paths([tmp_path])


def test_a_model_is_read_with_the_constants_of_its_crane(tmp_path):
    """`gap`, `identify` and `replay` write what they read: a term that reads the gear ratio needs it in the file."""
    silent = tmp_path / "silent.yaml"
    silent.write_text(model_to_text(replace(load_model("a6vm215_crane2"), constants={})))
    crane, model = machine_of("crane_150t", str(silent), (), Problems())
    assert model.constants == {"gear_ratio": crane.gear_ratio, "max_displacement": crane.max_displacement}
