"""Steps 3 and 4 of paper 2 and its second loop: the remaining system friction, then the motor on measured data."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from scipy.linalg import block_diag

from winch_friction.identification.fit import FitResult, fit
from winch_friction.identification.fit_data import FitData
from winch_friction.physics.friction import FrictionModel, term_named

EQUATION_8 = ("stribeck", "coulomb", "viscous", "gear_load_loss")
EQUATION_10 = ("stribeck", "viscous", "gear_load_loss")
STOP_GAIN = 0.01  # a loop that lowers the cost by less than 1 % is the last
MAX_LOOPS = 10


def system_start(terms: Sequence[str] = EQUATION_10) -> FrictionModel:
    """The system model of paper 2 eq 10 (or eq 8) at typical values: where a fit starts."""
    declared = tuple(term_named(name) for name in terms)
    values = tuple(parameter.typical for term in declared for parameter in term.parameters)
    return FrictionModel("system", declared, values)


def fit_system(
    data: FitData,
    motor: FrictionModel,
    terms: Sequence[str] = EQUATION_10,
    method: str = "least_squares",
    *,
    seed: int = 0,
    **options: int,
) -> FitResult:
    """Subtract the motor loss (paper 2 eq 7) and fit the system model with the cost of eq 9."""
    return fit(system_start(terms), data.without(motor), method, seed=seed, **options)


def combined(motor: FrictionModel, system: FrictionModel, name: str) -> FrictionModel:
    """Motor and system in one model; covariances side by side, without correlation between them."""
    covariance = None
    if motor.covariance is not None and system.covariance is not None:
        covariance = block_diag(motor.covariance, system.covariance)
    return replace(
        motor,
        name=name,
        terms=motor.terms + system.terms,
        values=motor.values + system.values,
        bounds={**motor.bounds, **system.bounds},
        constants={**system.constants, **motor.constants},
        covariance=covariance,
    )


@dataclass(frozen=True)
class Loop:
    """State after one loop: `cost` is eq 9 on the fitted tests."""

    number: int
    motor: FrictionModel
    system: FrictionModel
    cost: float
    evaluations: int

    @property
    def model(self) -> FrictionModel:
        """The whole model."""
        return combined(self.motor, self.system, f"loop_{self.number}")


def second_loop(
    data: FitData, motor: FrictionModel, terms: Sequence[str] = EQUATION_10, max_loops: int = MAX_LOOPS
) -> list[Loop]:
    """The first loop and those after it: motor reopened with the system locked, then the system again (paper 2 Fig 9).

    Stops when a loop gains less than 1 % of the cost; at most `max_loops` in all.
    """
    first = fit_system(data, motor, terms)
    loops = [Loop(1, motor, first.model, first.cost, first.evaluations)]
    while len(loops) < max_loops:
        loops.append(_next_loop(data, loops[-1], terms))
        if loops[-1].cost > (1.0 - STOP_GAIN) * loops[-2].cost:
            break
    return loops


def _next_loop(data: FitData, last: Loop, terms: Sequence[str]) -> Loop:
    motor = fit(last.motor, data.without(last.system))
    system = fit_system(data, motor.model, terms)
    return Loop(last.number + 1, motor.model, system.model, system.cost, motor.evaluations + system.evaluations)
