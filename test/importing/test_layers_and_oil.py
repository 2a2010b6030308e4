"""A log that counts layers from 0, and oil in another unit than its column says: asked, answered, imported rightly."""

import numpy as np
import pytest
from importing.logs import example

from winch_friction.importing.carry_out import import_log
from winch_friction.importing.map_text import map_text
from winch_friction.importing.mapping import load_map
from winch_friction.importing.propose import propose
from winch_friction.records.crane_file import load_crane

CRANE = load_crane("crane_150t")
COLUMNS = {"motor_speed": "Speed [rad/s]", "main.pressure_a": "Pressure A [bar]", "main.pressure_b": "Pressure B [Pa]",
           "main.displacement": "Displacement [m^3/rad]", "hook_load": "Load [kg]"}  # fmt: skip


def write(folder, **further):
    run = example("test_05")
    columns = {"Time [s]": run.time} | {name: run[channel] for channel, name in COLUMNS.items()}
    columns["Pressure A [bar]"] = 1e-5 * columns["Pressure A [bar]"]
    columns |= {name: np.broadcast_to(values, len(run)) for name, values in further.items()}
    path = folder / "log.csv"
    rows = "\n".join(",".join(f"{value:.9g}" for value in row) for row in zip(*columns.values(), strict=True))
    path.write_text(",".join(columns) + "\n" + rows + "\n", encoding="utf-8")
    return path, run


def test_a_layer_zero_is_asked_and_one_is_added_where_the_person_says_so(tmp_path):
    layers = np.where(np.arange(len(example("test_05"))) < 500, 0.0, 1.0)
    path, _ = write(tmp_path, Layer=layers)
    (question,) = propose([path], CRANE).problems
    assert question.startswith("wire_layer: 'Layer' has a layer 0, and layers count from 1, the innermost: --set")
    answered = propose([path], CRANE, settings=["wire_layer.add=1"]).log_map
    (tmp_path / "map.yaml").write_text(map_text(answered), encoding="utf-8")
    run = import_log(path, load_map(tmp_path / "map.yaml"), CRANE)
    assert run["wire_layer"].tolist() == (layers + 1.0).tolist()


@pytest.mark.parametrize(("oil", "unit"), [(104.0, "degF"), (313.15, "kelvin")])
def test_oil_that_is_too_hot_is_asked_for_its_unit(tmp_path, oil, unit):
    path, _ = write(tmp_path, **{"Oil temperature [degC]": oil})
    (question,) = propose([path], CRANE).problems
    assert f"'{unit}' would give a usual size: set oil_temperature.unit={unit}" in question
    run = import_log(path, propose([path], CRANE, settings=[f"oil_temperature.unit={unit}"]).log_map, CRANE)
    assert run["oil_temperature"][0] == pytest.approx(40.0)
    assert not propose([path], CRANE, settings=["oil_temperature.unit=degC"]).problems or unit == "kelvin"


def test_an_amount_is_added_in_the_logs_own_unit(tmp_path):
    path, given = write(tmp_path)
    log_map = propose([path], CRANE, settings=["main.pressure_a.add=-0.5"]).log_map
    assert import_log(path, log_map, CRANE)["main.pressure_a"] == pytest.approx(given["main.pressure_a"] - 5e4)
