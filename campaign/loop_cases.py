"""Cases, rows and scores of the closed-loop study (`campaign.loop`)."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.estimation import FrictionEstimator
from winch_friction.estimation.dynamics import FIRST_PARAMETER
from winch_friction.physics.channels import RPM
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import run_drum_torque
from winch_friction.physics.winch.operating_point import run_operating_points
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation.scenario import Scenario, load_scenario
from winch_friction.simulation.simulator import Simulator

LEARNING_SEED, TUNING_SEED = 201, 301  # neither is scored
SETTLED = 20.0  # s; the sea's ramp and the feedforward's fade are over
BEFORE, AFTER = 0.2, 1.0  # s; window around a reversal
LEARNING_PERIODS = 20
DURATION = 80.0  # s of every scored run
SPEED_BINS = (10, 50, 100, 229, 500, 1000, 1500, 2100)  # rpm
VISITED = 50  # samples that make a speed bin count
EFFICIENCIES = np.arange(0.74, 0.95, 0.02)
LEAD = 0.02  # s
REVERSAL_TIME = {"winch_150t": 0.05, "winch_150t_slow_pump": 0.15}  # s

CRANE = load_crane("crane_150t")
SEED = load_model("a6vm215_crane2")
MOTORS = CRANE.motor_total(("active", "passive"))
SYSTEM = ("C1", "C3", "C5", "C6")


@dataclass(frozen=True)
class Sea:
    """A sea of the study."""

    name: str
    period: float  # s, of the peak
    content: dict[str, Any]

    @property
    def regular(self) -> bool:
        """Whether it is the same for every seed."""
        return self.content["kind"] in ("regular", "measured")


def jonswap(height: float, period: float) -> Sea:
    """An irregular sea."""
    return Sea(f"Hs {height:g} m", period, {"kind": "jonswap", "significant_height": height, "peak_period": period})


SEAS = (
    Sea("regular 0.5 m", 8.0, {"kind": "regular", "amplitude": 0.5, "period": 8.0}),
    Sea("regular 1.5 m", 10.0, {"kind": "regular", "amplitude": 1.5, "period": 10.0}),
    jonswap(0.3, 7.0),
    jonswap(1.0, 8.0),
    jonswap(3.0, 10.0),
    Sea("a ship's heave, measured", 10.7, load_scenario("ahc_measured_heave").sea.dict()),
)
LOADS = (15e3, 55e3, 100e3)
DRIVES = {"primary": "pump-controlled", "secondary": "torque-commanded"}
ROWS = ("no feedforward", "efficiency", "seed x 0.9", "learned x 0.9", "perfect x 0.9")


@dataclass(frozen=True)
class Score:
    """Mean squares of the position error of one run, m^2: overall and around the reversals."""

    overall: float
    reversal: float


def raised(model: FrictionModel, names: Iterable[str], factor: float = 1.3) -> FrictionModel:
    """The model with these parameters times a factor."""
    return model.with_values({name: factor * model.value(name) for name in names})


TRUTHS = {
    "1.3 x the seed": raised(SEED, (name for name in SEED.parameter_names if name != "C4")),
    "system friction + 30 %": raised(SEED, SYSTEM),
}


def scenario(drive: str, load: float, sea: Sea, duration: float = DURATION, **changes: Any) -> Scenario:
    """Heave compensation of one case."""
    base = {"drive": drive, "load": load, "sea": sea.content, "duration": duration}
    return load_scenario("ahc_55t_215").override({**base, **changes})


def compensator(
    model: FrictionModel, seed: FrictionModel = SEED, scale: float = 0.9, plant: str = "winch_150t"
) -> FeedforwardCompensator:
    """The product's feedforward with this model."""
    settings = CompensatorConfig(scale=scale, lead=LEAD, reversal_time=REVERSAL_TIME[plant])
    each = FeedforwardCompensator(CRANE, seed, settings)
    each.load_model(model)
    return each


def closed_loop(
    case: Scenario,
    truth: FrictionModel,
    seed: int,
    feedforward: FeedforwardCompensator | None,
    watch: Callable[..., Any] | None = None,
) -> Simulator:
    """Run a case with the feedforward in the loop, sample by sample, as the nodes do; `watch` sees every fresh
    sample."""
    crane = Simulator(case, CRANE, truth, seed=seed)
    torque = 0.0
    while not crane.finished:
        if crane.fresh and watch is not None:
            watch(crane.sample)
        if crane.fresh and feedforward is not None:
            torque = feedforward.step(crane.sample).friction_torque
        crane.step(torque)
    return crane


def reversals(truth: Run) -> np.ndarray:
    """Which rows lie in the window around a reversal of the reference."""
    speed, period = truth["speed_reference"], truth.time[1] - truth.time[0]
    crossings = np.zeros(len(truth))
    crossings[1:] = speed[1:] * speed[:-1] < 0.0
    window = np.ones(int(round((BEFORE + AFTER) / period)))
    inside = np.convolve(crossings, window)[: len(truth)] > 0.0
    return np.roll(inside, -int(round(BEFORE / period)))


def score(crane: Simulator) -> Score:
    """Position error of a finished run, its mean taken out: a constant offset is not heave."""
    truth = crane.result().truth
    settled = truth.time > SETTLED
    error = truth["position_error"] - truth["position_error"][settled].mean()
    return Score(float(np.mean(error[settled] ** 2)), float(np.mean(error[settled & reversals(truth)] ** 2)))


# -- the rows' models
def efficiency_model(efficiency: float) -> FrictionModel:
    """Today's practice as a friction model: a constant share of the load torque, T_f = (1/eta - 1) T_d / i."""
    constant = SEED.subset(["gear_load_loss"]).with_covariance(None)
    return constant.with_values({"C6": (1.0 / efficiency - 1.0) / (MOTORS * CRANE.gear_ratio)})


def tuned_efficiency(drive: str, truth: FrictionModel) -> float:
    """The efficiency with the smallest position error at 55 t over two seas."""
    seas = (SEAS[1], SEAS[3])

    def error(efficiency: float) -> float:
        model = efficiency_model(efficiency)
        runs = (
            closed_loop(scenario(drive, 55e3, sea), truth, TUNING_SEED, compensator(model, model, 1.0)) for sea in seas
        )
        return sum(score(run).overall for run in runs)

    return float(min(EFFICIENCIES, key=error))


@dataclass(frozen=True)
class Learned:
    """A learned model, the worst error of its friction over the visited speed bins, and the NIS share inside its
    band; NEES of all parameters together, what it is on average where the stated covariance is true, and the share of
    them within three stated sigma of the truth."""

    model: FrictionModel
    worst_bin: float
    nis_inside: float
    nees: float
    honest: float
    within: float


def honest_nees(
    covariance: FloatArray, prior: FloatArray, sensitivity: FloatArray, errors: Sequence[float], off: FloatArray
) -> float:
    """The mean NEES of a filter that is right, where the considered errors and the truth are what they are.

    `covariance` (m, m) is the parameters' without the errors, `prior` (m, m) what it was before the data,
    `sensitivity` (k, m) what one sigma of each error does to the parameters, `errors` how many sigma each is, `off`
    (m,) by how much the truth is off the prior's mean. Averaged over errors and truths that are drawn it is m. Without
    errors it is less: the stated covariance holds room for what is not there. So it is with a truth that differs from
    the seed by what the data tell: of what they do not tell nothing is wrong then.
    """
    stated = covariance + sensitivity.T @ sensitivity
    kept = np.linalg.solve(prior, covariance).T  # of what the truth is off, what no data took away
    by_noise = covariance - kept @ covariance
    known = np.asarray(errors, float) @ sensitivity + kept @ off  # the truth beyond the mean estimate
    return float(np.trace(np.linalg.solve(stated, by_noise)) + known @ np.linalg.solve(stated, known))


def learn(
    drive: str, load: float, sea: Sea, truth: FrictionModel, considered: Mapping[str, float] = {}, **changes: Any
) -> Learned:
    """Twenty wave periods of the estimator beside the seed's feedforward, on a sea that is not scored; `considered`
    errors of these changes, by name, in their own unit."""
    case = scenario(drive, load, sea, duration=LEARNING_PERIODS * sea.period, **changes)
    estimator = FrictionEstimator(CRANE, SEED)
    crane = closed_loop(case, truth, LEARNING_SEED, compensator(SEED), watch=estimator.step)
    model = estimator.model()
    errors = friction_errors(crane.result().run, truth, model)
    off = np.array(model.values) - np.array(truth.values)
    nees = float(off @ np.linalg.solve(model.covariance, off))
    within = float(np.mean(np.abs(off) < 3.0 * model.std))
    own = {
        "speed_delay": estimator.config.speed_delay_std,
        "displacement_scale": estimator.config.displacement_scale_std,
        "wire_damping": estimator.config.wire_damping_std,
    }
    sigmas = [considered.get(name, 0.0) / std for name, std in own.items()]
    inner = estimator._filter
    one_sigma = inner.sensitivity[:, FIRST_PARAMETER:] * np.array(list(own.values()))[:, None]
    known = estimator._parameters
    truth_off = (np.array(truth.values) - known.center)[known.free] / known.scale
    honest = honest_nees(inner.phi_covariance, known.prior, one_sigma, sigmas, truth_off)
    inside = float(estimator.consistency.share_inside)
    return Learned(model, max(map(abs, errors.values())), inside, nees, honest, within)


def friction_errors(run: Run, truth: FrictionModel, model: FrictionModel) -> dict[int, float]:
    """Relative error of the mean friction by speed bin (lower edge, rpm) that the run visited."""
    x = run_operating_points(run, CRANE, drum_torque=run_drum_torque(run, CRANE))
    true, learned = (np.abs(np.asarray(each.torque(x), float)) for each in (truth, model))
    return {
        low: float(learned[inside].mean() / true[inside].mean() - 1.0)
        for low, inside in bins(run["motor_speed"]).items()
        if inside.sum() >= VISITED
    }


def bins(speed: FloatArray) -> dict[int, np.ndarray]:
    """Which samples lie in which speed bin (lower edge, rpm)."""
    magnitude = np.abs(speed) / RPM
    return {low: (magnitude >= low) & (magnitude < high) for low, high in zip(SPEED_BINS, SPEED_BINS[1:], strict=False)}
