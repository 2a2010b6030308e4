"""A friction term of the user's own in running nodes: its file is loaded, its model is used and learned."""

from pathlib import Path

import pytest
from dds_bench import Bench, efforts
from own_term_files import PARAMETER, TERM, own_model, own_terms
from std_msgs.msg import String

from winch_friction.nodes.qos import LATCHED
from winch_friction.physics.errors import InputError

HALF_PERIOD = 3.0  # s of the bench's swell: the speed has had its peak of 100 rad/s


def test_a_running_compensator_takes_over_a_model_with_a_users_own_term(bench: Bench, tmp_path: Path) -> None:
    bench.start("compensator", ramp_time=0.1)
    node, torque = bench.remote("compensator"), bench.listen("compensator/friction_torque")
    node.set({"model_file": str(own_model(tmp_path))})
    with pytest.raises(InputError, match=f"'{TERM}' is not known"):
        node.trigger("load_model")
    node.set({"terms_file": str(tmp_path / "missing.py")})
    with pytest.raises(InputError, match=r"missing\.py: not a readable"):
        node.trigger("load_model")
    bench.announce()
    bench.drive(HALF_PERIOD)
    by_seed = max(map(abs, efforts(torque)))
    node.set({"terms_file": str(own_terms(tmp_path))})
    assert "'repaired' in use" in node.trigger("load_model")
    node.set({f"gains.{TERM}": 0.5})
    count = len(torque)
    bench.drive(HALF_PERIOD)
    more = max(map(abs, efforts(torque)[count:])) - by_seed
    assert more == pytest.approx(0.9 * 0.5 * 1.0 * 100.0, rel=0.1)  # scale x gain x k x speed, N m


def test_estimator_and_compensator_start_on_a_users_own_term(bench: Bench, tmp_path: Path) -> None:
    files = {"terms_file": own_terms(tmp_path), "model_file": own_model(tmp_path)}
    bench.start("compensator", "-p", f"gains.{TERM}:=0.5", **files)
    bench.start("estimator", model_period=1.0, **files)
    models = bench.listen("friction_model", String, LATCHED)
    bench.announce(subscribers=2)
    bench.drive(0.5)
    assert bench.spin(5.0, lambda: bool(models))
    assert TERM in models[0].data
    assert PARAMETER in models[0].data
    assert bench.remote("compensator").get(f"gains.{TERM}").double_value == 0.5
    assert "not known" not in bench.log("compensator")
