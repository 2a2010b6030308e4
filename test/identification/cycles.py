"""Logged cycles written straight from the torque balance, to test every step on a known truth without a plant."""

import numpy as np

from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane, operating_point

SPEEDS = (20, 40, 70, 110, 160, 230, 350, 500, 700, 900, 1100)
TABLE_2 = {"Test 1": (215, 2), "Test 2": (215, 79), "Test 3": (215, 109), "Test 4": (164, 2), "Test 5": (164, 79),
           "Test 6": (164, 109), "Test 7": (200, 2)}  # fmt: skip
TABLE_5 = {"Test 8": (200, 109), "Test 9": (146, 79), "Test 10": (120, 79), "Test 11": (146, 109), "Test 12": (102, 2)}


def drive_pressure(model, crane: Crane, speed, displacement, load):
    """Pressure drop in Pa at constant speed: load plus friction, solved to consistency."""
    drum_torque = crane.drum_torque(load)
    motors = crane.motor_count("main")
    pressure = np.full_like(speed, drum_torque / (crane.gear_ratio * motors * displacement))
    for _ in range(30):
        x = operating_point(
            direction=np.sign(speed),
            speed=speed,
            drum_torque=drum_torque,
            groups=[(float(motors), np.abs(pressure), np.abs(pressure), displacement)],
            motor_total=float(motors),
        )
        pressure = (drum_torque / crane.gear_ratio + model.torque(x)) / (motors * displacement)
    return pressure


def cycle(model, crane, name, cm3, tonnes, *, speeds=SPEEDS, directions=(1, -1), noise=1.0, seed=0, rate=25.0) -> Run:
    """A test cycle: every speed for 5 s in every direction, ramps between; noise 1 is 0.3 bar and 1 rpm."""
    rng = np.random.default_rng(seed)
    levels = [0.0] + [d * s for s in speeds for d in directions] + [0.0]
    knots_t, knots_w, t = [0.0], [0.0], 0.0
    for before, after in zip(levels[:-1], levels[1:], strict=True):
        t += max(abs(after - before) / 1200.0, 0.2)
        knots_t += [t, t + 5.0]
        knots_w += [after, after]
        t += 5.0
    time = np.arange(0.0, t, 1.0 / rate)
    speed = np.interp(time, knots_t, knots_w) * RPM
    displacement = cm3 * CM3_PER_REV
    drop = drive_pressure(model, crane, speed, displacement, tonnes * 1e3)
    count = len(time)
    return Run(
        name=name,
        columns={
            "time": time,
            "motor_speed": speed + noise * RPM * rng.standard_normal(count),
            "main.pressure_a": 25 * BAR + drop + noise * 0.3 * BAR * rng.standard_normal(count),
            "main.pressure_b": 25 * BAR + noise * 0.3 * BAR * rng.standard_normal(count),
            "main.displacement": np.full(count, displacement),
            "hook_load": np.full(count, tonnes * 1e3),
        },
    )


def cycles(model, crane, tests, **options):
    """One run per test of a table."""
    return [cycle(model, crane, name, *test, seed=k, **options) for k, (name, test) in enumerate(tests.items())]
