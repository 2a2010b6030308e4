"""A drive whose torque is measured: no pressures, no groups."""

import math

from dds_bench import Bench, efforts
from diagnostic_msgs.msg import DiagnosticArray
from sensor_msgs.msg import FluidPressure

from winch_friction.physics.signals import Sample


def test_an_electric_drive_is_compensated_and_learned(bench: Bench) -> None:
    narrow = {"reversal_speed": 0.01, "reversal_time": 0.0}
    common = {"crane": "emps", "model_file": "emps_viscous"}
    bench.start("compensator", velocity_source="measured", load=0.0, ramp_time=0.1, **narrow, **common)
    bench.start("estimator", excitation_speed=0.05, stick_speed=0.005, **common)
    fed, learned = (bench.listen(f"{node}/friction_torque") for node in ("compensator", "estimator"))
    pressures = bench.listen("compensator/pressure_feedforward", FluidPressure)
    seen = bench.listen("/diagnostics", DiagnosticArray, 10)
    bench.announce(subscribers=2)

    def as_drive(sample: Sample) -> None:
        sample.motor_speed = sample.speed_reference = 0.1 * math.sin(sample.time * 2.0)
        acceleration = 0.2 * math.cos(sample.time * 2.0)
        sample.motor_torque = 95.0 * acceleration + 203.0 * sample.motor_speed + math.copysign(20.0, sample.motor_speed)
        sample.groups, sample.hook_load = {}, float("nan")

    sent = bench.drive(2.5, as_drive)
    assert pressures == []
    assert 10.0 < max(map(abs, efforts(fed))) < 60.0
    assert len(learned) > 0.8 * len(sent)
    assert all(map(math.isfinite, efforts(learned)))
    assert seen
