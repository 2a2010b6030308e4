"""A winch and a simulation of it that share nothing with the package: plain formulas, friction unlike any model's."""

import numpy as np

from winch_friction.physics.signals import Run

GRAVITY, GEAR, RADIUS, INERTIA, MOTORS = 9.80665, 250.0, 1.136, 1.54, 11
STEP = 0.02  # s


def friction(speed, load, displacement):
    """What the user's simulation believes, N m at the shaft: tanh instead of a sign, no Stribeck curve."""
    level = 0.11 * load * GRAVITY * RADIUS / GEAR + 60.0
    return np.tanh(speed / 2.0) * level + 1.9 * speed + 0.0 * displacement


def churning(speed):
    """What it lacks, N m at the shaft."""
    return np.sign(speed) * 11 * 4.0 * (np.abs(speed) / 209.0) ** 2


def cycle(k, name, missing=True):
    """A joystick cycle in normal mode with what was logged and what the simulation says."""
    rng = np.random.default_rng(k)
    time = np.arange(0.0, 110.0, STEP)
    knots = np.arange(0.0, 160.0, 12.0)
    levels = rng.uniform(-190.0, 190.0, len(knots))
    speed = np.interp(time, knots, levels)
    kernel = np.hanning(75)
    speed = np.convolve(np.pad(speed, 37, mode="edge"), kernel / kernel.sum(), mode="valid")[: len(time)]
    load = float(rng.choice((20e3, 45e3, 80e3)))
    displacement = float(rng.choice((110.0, 160.0, 215.0))) * 1e-6 / (2.0 * np.pi)
    acceleration = np.gradient(speed, STEP)
    lever = RADIUS / GEAR
    torque = load * GRAVITY * lever + (INERTIA + load * lever**2) * acceleration + friction(speed, load, displacement)
    simulated = torque / (MOTORS * displacement)
    measured = (torque + (churning(speed) if missing else 0.0)) / (MOTORS * displacement)
    measured = measured + 0.3e5 * rng.standard_normal(len(time))
    columns = {
        "time": time, "motor_speed": speed + 0.02 * rng.standard_normal(len(time)),
        "main.pressure_a": measured + 25e5, "main.pressure_b": np.full(len(time), 25e5),
        "main.displacement": np.full(len(time), displacement), "hook_load": np.full(len(time), load),
        "wire_layer": np.full(len(time), 6.0), "main.pressure_drop_simulated": simulated,
    }  # fmt: skip
    return Run(name, columns)
