"""The simulated crane: period by period for a closed loop, or a whole run at once; the same computation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.model import FrictionModel, completed
from winch_friction.physics.signals import FloatArray, GroupSample, Run, Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.simulation.assembly import (
    control_record,
    plant_record,
    prescribed_motion,
    schedule,
    viscous_parameters,
)
from winch_friction.simulation.compiling import in_order
from winch_friction.simulation.control.settings import CONTROL_STATES
from winch_friction.simulation.hidden.catalogue import apply_effects
from winch_friction.simulation.model_errors import put_errors
from winch_friction.simulation.plant.friction_kernel import friction_kernel
from winch_friction.simulation.plant.loop import run_periods
from winch_friction.simulation.plant.point import POINT_LENGTH
from winch_friction.simulation.plant.start import equilibrium, first_row
from winch_friction.simulation.plant.state import COLUMNS, ROW, STATES
from winch_friction.simulation.plant_file import PlantFile, load_plant
from winch_friction.simulation.scenario import Scenario
from winch_friction.simulation.sensors.channels import channels
from winch_friction.simulation.sensors.plc import draw_scans, scan, scan_all

Hidden = Sequence[tuple[str, float]] | Mapping[str, float]


@dataclass(frozen=True)
class SimulationResult:
    """`run`: what the PLC logged; `truth`: the plant at every control tick (columns of `plant.state.COLUMNS`, SI)."""

    run: Run
    truth: Run


class Simulator:
    """A crane in a scenario. `model` is the friction's truth; `hidden` adds effects as (name, size), 1 = typical.

    The model's corrections are true too: sensors, geometry, load and inertia of the plant have the errors that they
    speak of, so that model and log agree.

    `step` advances one control period. The sea, the sensors' noise and the controller's are drawn from `seed`.
    """

    def __init__(
        self,
        scenario: Scenario,
        crane: Crane,
        model: FrictionModel,
        seed: int = 0,
        hidden: Hidden = (),
        plant: PlantFile | None = None,
    ) -> None:
        plant = plant or load_plant(scenario.plant)
        model = completed(model, crane)
        self.scenario, self.crane, self.model, self.seed = scenario, crane, model, seed
        self.period = scenario.control_period
        self.periods = int(round(scenario.duration / self.period))
        nominal = plant_record(scenario.override({"mismatch": {}}) if scenario.mismatch else scenario, crane, plant)
        self._plant = plant_record(scenario, crane, plant)
        self._control = control_record(scenario, crane, plant, nominal)
        self.channels = channels(scenario)
        pairs = (*scenario.hidden.items(), *(hidden.items() if isinstance(hidden, Mapping) else hidden))
        self.hidden = tuple((str(name), float(size)) for name, size in pairs)
        put_errors(model, scenario, crane, self._plant, self.channels)
        self._torque = apply_effects(self.hidden, self._plant, self.channels, crane.drum.layer_radii)
        self._draw(seed)
        self._reset()

    def _draw(self, seed: int) -> None:
        if seed < 0:
            raise InputError(f"seed {seed}: give a whole number, 0 or more")
        sensors, controller = (np.random.default_rng([seed, stream]) for stream in (1, 2))
        time = np.arange(self.periods + 1, dtype=np.float64) * self.period
        self.motion = prescribed_motion(self.scenario, self.crane, time, seed, self._full_speed())
        self._schedule = schedule(self.scenario, time, self._plant, self._control)
        self._scans = draw_scans(self.scenario, self.channels, sensors)
        self._noise = controller.standard_normal((self.periods + 1, 2))

    def _full_speed(self) -> float:
        control = self._control[0]
        return float(control["pump_flow"] / control["drive_displacement"])

    def _reset(self) -> None:
        settings = self.scenario.sensors
        kernel = friction_kernel(self.model)
        nominal = np.array(self.model.values, float)
        terms = np.array(kernel.initial_states, float)
        step = 2.0 * np.pi / settings.encoder_counts if settings.encoder_counts and settings.quantisation else 0.0
        spread = settings.pressure_noise if settings.noise else 0.0
        self._kernel = kernel
        self._x = np.zeros(POINT_LENGTH)
        self._state, self._memory = equilibrium(self._plant, self._control)
        self.feedforward = np.zeros(self.periods + 1)
        self.history = np.zeros((self.periods + 1, len(COLUMNS)))
        self._arguments = in_order(
            run_periods, "first", "count",
            plant=self._plant, effects=self._torque, controller=self._control,
            addresses=np.array([kernel.torque_address, kernel.rates_address], np.int64),
            nominal=nominal, viscous=viscous_parameters(self.model), theta=nominal.copy(),
            z=terms, gains=np.zeros(2 * len(terms)), memory=self._memory, x=self._x,
            state=self._state, stages=np.zeros((5, len(STATES))), control_memory=np.zeros(CONTROL_STATES),
            measured=np.zeros(4), sensing=np.array([step, spread, self.period]), noise=self._noise,
            schedule=self._schedule, motion=np.ascontiguousarray(self.motion.tip), reference=self.motion.reference,
            oil=self.motion.oil, feedforward=self.feedforward, history=self.history.view(ROW)[:, 0],
            substeps=max(1, round(self.period / self.scenario.step)),
        )  # fmt: skip
        self.tick = 0
        self._scan = 0
        self._row = np.zeros(len(self.channels.names) + 1)
        first_row(self._plant, self._state, self.motion, self.history)
        self.fresh = True
        self.sample = self._measure(0)

    # -- stepping
    @property
    def time(self) -> float:
        """Simulated time in s."""
        return self.tick * self.period

    @property
    def finished(self) -> bool:
        """Whether the scenario's duration is over."""
        return self.tick >= self.periods

    def step(self, friction_feedforward: float = 0.0) -> Sample:
        """One control period on with this friction torque fed forward (N m, total at the motor shaft).

        Returns the PLC's latest row; `fresh` tells whether it is new (the sensors may be slower than the control).
        """
        if self.finished:
            raise InputError(f"scenario '{self.scenario.name}' is over after {self.scenario.duration:g} s")
        self.feedforward[self.tick] = friction_feedforward
        run_periods(self.tick, 1, *self._arguments)
        self.tick += 1
        due = int((self.time - self.scenario.sensors.delay) * self.scenario.sensors.rate + 1e-9)
        self.fresh = due > self._scan
        if self.fresh:
            self._scan = due
            self._take(due)
        return self.sample

    def _take(self, number: int) -> None:
        if not self._scans.lost[number]:
            self.sample = self._measure(number)
        elif self.scenario.sensors.dropout == "nan":
            lost = self._measure(number)
            groups = {name: GroupSample() for name in lost.groups}
            self.sample = Sample(time=lost.time, motor_speed=float("nan"), groups=groups)
        else:
            self.fresh = False

    def _measure(self, number: int) -> Sample:
        scan(
            self.history, self.period, self.channels.settings, self._scans.ends, self._scans.normals, number, self._row
        )
        values = self._row.tolist()
        scalars: dict[str, Any] = {}
        groups: dict[str, GroupSample] = {}
        for name, value in zip(self.channels.names, values[1:], strict=True):
            group, _, channel = name.rpartition(".")
            if group:
                setattr(groups.setdefault(group, GroupSample()), channel, value)
            else:
                scalars[name] = value
        if "wire_layer" not in self.scenario.sensors.absent:
            scalars["wire_layer"] = float(self.scenario.wire_layer)
        return Sample(
            time=self.scenario.start_time + values[0],
            groups=groups,
            **scalars,
        )

    def run(self, feedforward: FloatArray | None = None) -> "SimulationResult":
        """The rest of the scenario at once; `feedforward` holds one friction torque per remaining control period."""
        remaining = self.periods - self.tick
        if feedforward is not None:
            self.feedforward[self.tick : self.tick + remaining] = feedforward
        run_periods(self.tick, remaining, *self._arguments)
        self.tick = self.periods
        return self.result()

    # -- what happened
    def truth(self) -> dict[str, float]:
        """The plant now: true friction torque, position error, energies ... by name (`plant.state.COLUMNS`), SI."""
        return dict(zip(COLUMNS, self.history[self.tick].tolist(), strict=True))

    def result(self) -> SimulationResult:
        """Run and truth up to now."""
        rows = np.zeros((self._logged(), len(self.channels.names) + 1))
        scan_all(self.history, self.period, self.channels.settings, self._scans.ends, self._scans.normals, rows)
        lost = self._scans.lost[: len(rows)]
        if self.scenario.sensors.dropout == "missing":
            rows = rows[~lost]
        else:
            rows[lost, 1:] = np.nan
        columns = {"time": rows[:, 0].copy()}
        columns |= {name: rows[:, k + 1].copy() for k, name in enumerate(self.channels.names)}
        columns["time"] += self.scenario.start_time
        if "wire_layer" not in self.scenario.sensors.absent:
            columns["wire_layer"] = np.where(np.isnan(rows[:, 1]), np.nan, float(self.scenario.wire_layer))
        history = self.history[: self.tick + 1]
        truth = {name: history[:, k].copy() for k, name in enumerate(COLUMNS)}
        name = f"{self.scenario.name}_seed{self.seed}"
        return SimulationResult(
            Run(name, columns, metadata=self._provenance()),
            Run(f"{name}_truth", truth, metadata=self._provenance()),
        )

    def _logged(self) -> int:
        return int((self.time - self.scenario.sensors.delay) * self.scenario.sensors.rate + 1e-9) + 1

    def _provenance(self) -> dict[str, Any]:
        return {
            "source": "simulation",
            "scenario": self.scenario.name,
            "seed": self.seed,
            "crane": self.crane.name,
            "model": self.model.name,
            "start_time": self.scenario.start_time,
        }


def simulate(
    scenario: Scenario,
    crane: Crane,
    model: FrictionModel,
    seed: int = 0,
    hidden: Hidden = (),
    feedforward: FloatArray | None = None,
) -> SimulationResult:
    """A whole scenario at once."""
    return Simulator(scenario, crane, model, seed, hidden).run(feedforward)
