"""A small winch that tests drive themselves: the truth is the same balance of torques, written out independently."""

import math

import numpy as np

from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch import sample_operating_point

FULL = 11 * 215 * CM3_PER_REV  # m^3/rad, all motors in normal mode
LOAD = 55e3
PERIOD = 0.02


def rigid_samples(crane, truth, *, amplitude, period=10.0, duration=100.0, noise=None, speed_noise=0.0, load=LOAD):
    """Normal mode, rigid wire, tip at rest: the pressure that moves shaft and load sinusoidally against the true
    friction."""
    inertia = crane.inertia + crane.load_inertia(load)
    rng = np.random.default_rng(noise) if noise is not None else None
    for time in np.arange(0.0, duration, PERIOD).tolist():
        angle = 2 * math.pi * time / period
        speed = amplitude * math.sin(angle)
        acceleration = amplitude * 2 * math.pi / period * math.cos(angle)
        torque = load * GRAVITY * crane.drum.radius(float("nan")) / crane.gear_ratio + inertia * acceleration
        pressure = 130 * BAR
        for _ in range(3):  # the motor losses read the pressure that they raise
            groups = {"main": GroupSample(pressure + 25 * BAR, 25 * BAR, 215 * CM3_PER_REV)}
            sample = Sample(time, speed, groups=groups, hook_load=load)
            x = sample_operating_point(sample, crane, drum_torque=crane.drum_torque(load), speed=speed)
            pressure = (torque + float(truth.torque(x))) / FULL
        sample.groups["main"].pressure_a = pressure + 25 * BAR
        if rng is not None:
            sample.groups["main"].pressure_a += rng.normal(0.0, 0.3 * BAR)
            sample.groups["main"].pressure_b += rng.normal(0.0, 0.3 * BAR)
            sample.motor_speed += rng.normal(0.0, speed_noise)
        yield sample
