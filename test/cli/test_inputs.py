"""Which files of a folder are runs."""

import pytest

from winch_friction.cli.inputs import run_paths
from winch_friction.physics.errors import InputError


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
