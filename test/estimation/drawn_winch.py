"""Winches of any size, drawn, and a plant around them that shares nothing with the package but its units.

Shaft, wire and load in steps of 1 ms under a controller that follows the sea; the friction is Coulomb's, viscous and a
constant; a torque that no term explains comes on top. Every sensor has errors.
"""

import math

import numpy as np

from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.physics.channels import BAR, GRAVITY
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.friction.term import term_named
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.crane import Crane, Drive, Drum

TERMS = tuple(term_named(name) for name in ("coulomb", "viscous", "torque_offset"))
PERIOD, STEP = 0.02, 0.001  # s
PERIODS, SHARES = (6.3, 8.1, 9.7, 12.4), (1.0, 0.8, 0.6, 0.4)  # s of the sea's waves, and of their heave velocities
BOOST = 25 * BAR
ENCODER = 2.0 * math.pi / 1024  # rad
TORQUE_NOISE = 0.0005  # of an electric motor's torque, of what holds the rated load


def drawn_crane(tonnes, kind, rng):
    """A crane of this rated load: gear from the rope's and the motor's speed, a wire of 1/130 to 1/300 strain."""
    load, fast = 1e3 * tonnes, rng.uniform(150.0, 300.0)
    radius = 1.136 * (tonnes / 150.0) ** (1.0 / 3.0) * rng.uniform(0.8, 1.2)
    rope = 2.2 * (tonnes / 20.0) ** -0.2 * rng.uniform(0.8, 1.25)  # m/s
    lever = rope / fast
    held, motors = load * GRAVITY * lever, max(1, round(tonnes / 14.0))
    hydraulic = kind == "hydraulic"
    return Crane(
        f"drawn_{tonnes:g}t", radius / lever, Drum((radius,)), {"main": motors} if hydraulic else {},
        load * lever**2 * rng.uniform(0.3, 1.0), max_displacement=held / motors / (250 * BAR) if hydraulic else 0.0,
        drive=Drive(kind), wire_stiffness=load * GRAVITY * rng.uniform(130.0, 300.0), rated_load=load,
        rated_speed=1.5 * fast, absolute_torque_limit=0.4 * held,
    )  # fmt: skip


def motors_of(crane):
    """Motors on the shaft in normal mode."""
    return crane.motor_total(("main",) if crane.drive.hydraulic else ())


def held_torque(crane):
    """What holds the rated load, N m at the shaft."""
    return crane.rated_load * GRAVITY * crane.drum.layer_radii[-1] / crane.gear_ratio


def drawn_friction(crane, rng):
    """A seed model, and a truth out of its own sigmas, as values."""
    motors = motors_of(crane)
    level = held_torque(crane) * rng.uniform(0.015, 0.05)
    values = np.array([level / motors, 0.002 * level / motors, 0.2 * level])
    sigma = np.array([0.2, 0.2, 0.5]) * values
    seed = FrictionModel(terms=TERMS, values=tuple(values.tolist()), covariance=np.diag(sigma**2), name="seed")
    return seed, values + sigma * rng.standard_normal(3)


def samples(crane, seed, truth, rng, seconds, displacement=1.0):
    """What the sensors of a winch with this friction show in heave compensation, its displacement read that much too
    large."""
    motors, lever = motors_of(crane), crane.drum.layer_radii[-1] / crane.gear_ratio
    mass, length = crane.rated_load * rng.uniform(0.25, 0.8), rng.uniform(30.0, 150.0)
    stiffness = crane.wire_stiffness / length
    damping = 2.0 * rng.uniform(0.08, 0.18) * math.sqrt(stiffness * mass)
    known, true = (np.array(each) * (motors, motors, 1.0) for each in (seed.values, truth))
    amplitude = 0.18 * crane.rated_speed * lever * rng.uniform(0.5, 1.0)
    phases, hold = rng.uniform(0.0, 2.0 * math.pi, 4).tolist(), mass * GRAVITY * lever
    speed = stretch = load_speed = angle = rounding = odd = integral = heave = 0.0
    torque, inside = hold, round(PERIOD / STEP)
    for k in range(round(seconds / PERIOD)):
        odd += -odd * PERIOD / 0.3 + 0.0012 * held_torque(crane) * math.sqrt(2.0 * PERIOD / 0.3) * rng.standard_normal()
        for j in range(inside):
            time = (k * inside + j) * STEP
            heave = min(1.0, time / 8.0) * sum(
                share * amplitude * math.cos(2.0 * math.pi * time / period + phase)
                for share, period, phase in zip(SHARES, PERIODS, phases, strict=True)
            )
            behind = -heave / lever - speed
            integral += behind * STEP
            wanted = -heave / lever
            asked = hold + known[0] * math.tanh(wanted / 3.0) + known[1] * wanted
            torque += STEP * (asked + crane.inertia * (6.0 * behind + 4.0 * integral) - torque) / 0.05
            friction = true[0] * math.tanh(speed / 0.2) + true[1] * speed + true[2] + odd
            pull = stiffness * stretch + damping * (heave + lever * speed - load_speed)
            speed += STEP * (torque - hold - lever * pull - friction) / crane.inertia
            stretch += STEP * (heave + lever * speed - load_speed)
            load_speed += STEP * pull / mass
            angle += STEP * speed
        last, rounding = rounding, round(angle / ENCODER) * ENCODER - angle
        sample = Sample((k + 1) * PERIOD, speed + (rounding - last) / PERIOD, wire_out=length)
        sample.hook_load = mass * (1.0 + 0.002 * rng.standard_normal())
        sample.heave_velocity = heave + 0.003 * rng.standard_normal()
        if crane.drive.hydraulic:
            drop = torque / (motors * crane.max_displacement)
            a, b = (BOOST + drop, BOOST) + 0.3 * BAR * rng.standard_normal(2)
            sample.groups = {"main": GroupSample(float(a), float(b), crane.max_displacement * displacement)}
        else:
            sample.motor_torque = torque + TORQUE_NOISE * held_torque(crane) * rng.standard_normal()
        yield sample


def learned(crane, rng, seconds=120.0):
    """An estimator after so many s of a friction drawn from its seed, with a displacement error of 1 %, and the squared
    error of its parameters in their stated covariance (NEES, 3 on average)."""
    seed, truth = drawn_friction(crane, rng)
    noise = 0.0 if crane.drive.hydraulic else TORQUE_NOISE * held_torque(crane)
    estimator = FrictionEstimator(crane, seed, EstimatorConfig(torque_noise=noise))
    displacement = 1.0 + 0.01 * float(rng.standard_normal())
    for sample in samples(crane, seed, truth, rng, seconds, displacement):
        estimator.step(sample)
    model = estimator.model()
    error = np.array(model.values) - truth
    return estimator, float(error @ np.linalg.solve(model.covariance, error))
