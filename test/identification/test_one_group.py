"""A crane whose one motor group has a name of its own."""

from dataclasses import replace

import pytest
from cycles import cycles

from winch_friction.identification.system_identification import identify_system, winch_seed
from winch_friction.physics.friction.correction import Correction

OPTIONS = {"restarts": 1, "max_evaluations": 200}
TESTS = {"a": (215, 79), "b": (164, 109), "c": (200, 20)}


@pytest.mark.parametrize("corrected", [False, True])
def test_a_group_of_another_name_is_identified_like_main(truth, crane, spread, corrected):
    own = replace(crane, groups={"hoist": crane.groups["main"]})
    motor = truth.only("motor").with_covariance(None)
    runs = cycles(truth, crane, TESTS)
    offset = 5e5 if corrected else 0.0  # Pa
    known = (Correction("pressure_offset", offset, groups=("hoist",)),) if corrected else ()
    logs = [
        replace(run, columns={name.replace("main.", "hoist."): values + offset * (name == "main.pressure_a")
                              for name, values in run.columns.items()})
        for run in runs
    ]  # fmt: skip
    right = identify_system(runs, crane, motor, spread, complex_options=OPTIONS)
    found = identify_system(logs, own, replace(motor, corrections=known), spread, complex_options=OPTIONS)
    assert found.joint.model.values == pytest.approx(right.joint.model.values, rel=1e-4)
    assert winch_seed(found, own, "seed", {}).crane == own.name
