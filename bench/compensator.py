"""What one compensator step costs, beside the bare friction model at the same points.

python bench/compensator.py
"""

from typing import Any

from pairs import figure, paired
from seas import sea

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.physics.winch.operating_point import sample_operating_point


def measure() -> dict[str, Any]:
    """Step time in us over a simulated sea, and its ratio to evaluating the model's torque alone."""
    crane, model, _, samples = sea()
    torque, values = model.compile(2).scalar_torque, model.values
    points = [sample_operating_point(s, crane, drum_torque=5e5, speed=s.motor_speed, width=3.0) for s in samples]

    def steps() -> None:
        compensator = FeedforwardCompensator(crane, model, CompensatorConfig())
        for sample in samples:
            compensator.step(sample)

    def bare() -> None:
        for point in points:
            torque(point, values, ())

    ours, _, ratio = paired(steps, bare)
    value = 1e6 * ours / len(samples)
    return {"compensator: one step": figure(value, "us", "the bare friction model", ratio, "<= 15 us")}


if __name__ == "__main__":
    print(measure())
