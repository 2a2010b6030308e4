"""Steps 2 to 4 of the practice, the second loop and the joint fit: from logged test cycles to a winch model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from winch_friction.identification.bootstrap import Bootstrap, bootstrap
from winch_friction.identification.collinearity import Direction, Tie, ties, unseen_directions
from winch_friction.identification.fit import FitResult
from winch_friction.identification.fit_data import FitData, modelled
from winch_friction.identification.friction_curve import FrictionCurve, curve_data, friction_curve
from winch_friction.identification.joint_fit import JointFit, joint_fit, observations, winch_prior
from winch_friction.identification.one_group import as_main, run_as_main
from winch_friction.identification.plateaus import Plateau, PlateauRule, find_plateaus
from winch_friction.identification.prior import UnitSpread, supplier_prior
from winch_friction.identification.system_fit import EQUATION_8, EQUATION_10, Loop, fit_system, second_loop
from winch_friction.physics.corrections import corrected, corrected_crane
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane

DIFFERENT_LOAD = 1.2  # ratio of drum torques from which two tests tell the load's part of friction


@dataclass(frozen=True)
class Test:
    """One logged cycle: its run, plateaus and friction curve."""

    __test__ = False  # not a pytest class

    run: Run
    plateaus: tuple[Plateau, ...]
    curve: FrictionCurve


@dataclass(frozen=True)
class SystemIdentification:
    """All that steps 2 to 4 give.

    `fits` by name: eq 8 and eq 10, each by least squares and by the complex method. `loops` are the papers' loops,
    `held_out_costs` eq 9 on the held-out tests after each (empty without such tests); `joint` is the fit beyond the
    papers.
    """

    tests: tuple[Test, ...]
    held_out: tuple[Test, ...]
    motor: FrictionModel
    fits: dict[str, FitResult]
    loops: tuple[Loop, ...]
    held_out_costs: tuple[float, ...]
    joint: JointFit
    ties: tuple[Tie, ...]
    unseen: tuple[Direction, ...]
    bootstrap: Bootstrap | None

    @property
    def first_loop(self) -> FrictionModel:
        """Supplier's motor and the system fitted to what remains: paper 2 Table 3."""
        return replace(self.loops[0].model, name="first loop")

    @property
    def last_loop(self) -> FrictionModel:
        """After the second loop and those that followed: paper 2 Table 4."""
        return replace(self.loops[-1].model, name="second loop")

    @property
    def data(self) -> FitData:
        """The fitted tests as data."""
        return curve_data([test.curve for test in self.tests])


def read_test(run: Run, crane: Crane, rule: PlateauRule | None = None, group: str = "main") -> Test:
    """Plateaus and friction curve of one logged cycle; raises `InputError` naming the run."""
    plateaus = find_plateaus(run, crane, rule, group)
    if not plateaus:
        raise InputError(f"{run.name}: no stretch of constant speed was found; too few plateaus to measure friction")
    return Test(run, tuple(plateaus), friction_curve(plateaus, crane, group))


def identify_system(
    runs: Sequence[Run],
    crane: Crane,
    motor: FrictionModel,
    spread: UnitSpread,
    *,
    held_out: Sequence[Run] = (),
    resamples: int = 0,
    seed: int = 0,
    rule: PlateauRule | None = None,
    complex_options: Mapping[str, int] | None = None,
) -> SystemIdentification:
    """Everything from logged tests and a motor model with covariance; `complex_options`: restarts, max_evaluations.

    What the motor model's corrections say is wrong with the logs and the crane is taken out of both first.
    """
    if not runs:
        raise InputError("identify system: no logged test was given")
    as_given = crane
    crane = as_main(corrected_crane(as_given, motor.corrections))
    right = lambda run: run_as_main(corrected(run, as_given, motor)[0], as_given)
    tests = tuple(read_test(right(run), crane, rule) for run in runs)
    _check_loads(tests)
    others = tuple(read_test(right(run), crane, rule) for run in held_out)
    data = curve_data([test.curve for test in tests])
    loops = tuple(second_loop(data, motor))
    prior = winch_prior(supplier_prior(motor, spread), loops[0].system, "joint fit")
    rows = observations([test.plateaus for test in tests], crane)
    joint = joint_fit(rows, prior, spread)
    plateaus = [test.plateaus for test in tests]
    return SystemIdentification(
        tests=tests,
        held_out=others,
        motor=motor,
        fits=_fits(data, motor, seed, dict(complex_options or {})),
        loops=loops,
        held_out_costs=tuple(cost_of(loop.model, others) for loop in loops) if others else (),
        joint=joint,
        ties=tuple(ties(joint.model, rows)),
        unseen=tuple(unseen_directions(joint)),
        bootstrap=bootstrap(plateaus, crane, joint, spread, resamples=resamples, seed=seed) if resamples else None,
    )


def _check_loads(tests: Sequence[Test]) -> None:
    """Raise `InputError` where all tests hang one load: what goes with the load could not be told from the rest."""
    torques = [float(np.median([plateau.drum_torque for plateau in test.plateaus])) for test in tests]
    if max(torques) <= DIFFERENT_LOAD * max(min(torques), 0.0):
        raise InputError(
            f"identify system: {len(tests)} test(s) of one load ({min(torques) / 1e3:.4g} kN m at the drum): friction "
            "that goes with the load cannot be told from the rest; give tests of at least two loads"
        )


def _fits(data: FitData, motor: FrictionModel, seed: int, options: dict[str, int]) -> dict[str, FitResult]:
    named = {"eq 8": EQUATION_8, "eq 10": EQUATION_10}
    found = {f"{name}, least squares": fit_system(data, motor, terms) for name, terms in named.items()}
    return found | {
        f"{name}, complex": fit_system(data, motor, terms, "complex", seed=seed, **options)
        for name, terms in named.items()
    }


def cost_of(model: FrictionModel, tests: Sequence[Test]) -> float:
    """Cost of paper 2 eq 9 of a winch model on these tests, (N m)^2 per motor."""
    data = curve_data([test.curve for test in tests])
    return float(np.sum((data.torque - modelled(model, data)) ** 2))


def winch_seed(found: SystemIdentification, crane: Crane, name: str, provenance: dict[str, Any]) -> FrictionModel:
    """The joint fit as the online nodes' seed: values, full covariance, constants, where it comes from."""
    joint = found.joint
    said = {
        "method": "joint fit of motor and system to plateaus, supplier's fit as prior, sensor errors marginalised",
        "crane": crane.name,
        "tests": [test.run.name for test in found.tests],
        "cost_eq9": cost_of(joint.model, found.tests),
        "not_determined_by_these_tests": [str(direction) for direction in found.unseen],
        **provenance,
    }
    constants = {"gear_ratio": crane.gear_ratio, **joint.model.constants}
    return replace(
        joint.model, name=name, constants=constants, provenance=said, corrections=found.motor.corrections,
        crane=crane.name,
    )  # fmt: skip
