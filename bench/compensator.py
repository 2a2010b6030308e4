"""What one compensator step costs, beside the bare friction model at the same points."""

from bench.measuring import Row, paired, sea, sea_seconds
from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.physics.winch.operating_point import sample_operating_point


def measure(smoke: bool = False) -> list[Row]:
    """Step time over a simulated sea, and its ratio to evaluating the model's torque alone."""
    crane, model, _, samples = sea(sea_seconds(smoke))
    torque, values = model.compile(2).scalar_torque, model.values
    points = [sample_operating_point(s, crane, drum_torque=5e5, speed=s.motor_speed, width=3.0) for s in samples]

    def steps() -> None:
        compensator = FeedforwardCompensator(crane, model, CompensatorConfig())
        for sample in samples:
            compensator.step(sample)

    def bare() -> None:
        for point in points:
            torque(point, values, ())

    found, each = paired(steps, bare, smoke), 1e6 / len(samples)
    against = f"the bare model's torque, {found.theirs * each:.2g} us: {found.ratio:.1f} x"
    return [Row("compensator: one step", found.ours * each, "us", against, at_most=15.0)]
