"""The jobs: simulate, replay, fit, find what a model lacks; each returns an object that says what came out."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from winch_friction.api.arguments import checked
from winch_friction.api.results import Check, Fit, Gap, Replay
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane

if TYPE_CHECKING:
    from winch_friction.simulation import SimulationResult

Runs = Sequence["Run | str | Path"]


@checked
def simulate(
    scenario: str | Path,
    crane: Crane,
    model: FrictionModel,
    *,
    seed: int = 0,
    hidden: Mapping[str, float] | None = None,
    **changes: Any,
) -> "SimulationResult":
    """A scenario (file or shipped name) as the crane's PLC would have logged it.

    `model` is the friction's truth; `hidden` puts effects into the plant, name to size, 1 = typical; `changes`
    override keys of the scenario file (`duration=` s, ...). Returns an object with `run` (logged) and `truth` (the
    plant at every control tick), both `Run`, SI. Raises `InputError`.

    >>> import winch_friction as wf
    >>> crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    >>> result = wf.simulate("ahc_55t_215", crane, model, seed=1, duration=2.0)
    >>> result.run.groups, bool(abs(result.truth["position_error"]).max() < 0.5)
    (('active', 'passive'), True)
    """
    from winch_friction.simulation import load_scenario
    from winch_friction.simulation import simulate as simulated

    chosen = load_scenario(str(scenario))
    return simulated(chosen.override(changes) if changes else chosen, crane, model, seed, hidden or {})


@checked
def replay(recording: Run | str | Path, crane: Crane, model: FrictionModel, *, learn: bool = True,
           params_file: str | Path | None = None, namespace: str = "") -> Replay:  # fmt: skip
    """A run, run file or bag through the nodes' own step: what would have been fed forward, and what was learned.

    `model` is the seed; with `learn` the compensator takes over what the estimator learns; `params_file` is a
    ROS parameter file of the nodes (their defaults without it), which also says what a bag's topics mean; `namespace`
    tells which of several winches is meant, in a bag and in that file. Raises `InputError`.

    >>> import winch_friction as wf
    >>> crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    >>> run = wf.simulate("ahc_55t_215", crane, model, duration=20.0).run
    >>> result = wf.replay(run, crane, model)
    >>> result.parameters.columns.tolist()
    ['unit', 'seed', 'learned', 'sigma', 'status']
    >>> bool(result.compensator["friction_torque"].max() > 100.0)  # N m
    True
    """
    from winch_friction.records.input_mapping import bag_options_of
    from winch_friction.records.runs import is_bag
    from winch_friction.replay.recording import replay_recording, replay_run
    from winch_friction.replay.settings import ReplaySettings, settings_from_file

    of_bag = not isinstance(recording, Run) and is_bag(Path(recording))
    if namespace and not (params_file or of_bag):
        raise InputError(f"replay: namespace '{namespace}': a run is of one winch; leave it out")
    options = bag_options_of(Path(params_file) if params_file else None, namespace) if of_bag else {}
    settings = settings_from_file(Path(params_file), namespace) if params_file else None
    if isinstance(recording, Run):
        return Replay(replay_run(recording, crane, model, settings or ReplaySettings(), learn=learn), model)
    return Replay(replay_recording(recording, crane, model, settings, learn=learn, **options), model)


@checked
def fit(data: str | Path | Runs, crane: Crane | None = None, *, motor: FrictionModel | str = "mj4",
        held_out: Runs = (), seed: int = 0) -> Fit:  # fmt: skip
    """A friction model from a supplier's table, or from logged steady tests.

    A path alone is a supplier's table (CSV or shipped name): the motor-loss model named by `motor` (paper 1: wilson
    ... mj6) is fitted to it. A sequence of runs (or files) with a `crane` is fitted by paper 2's steps and the joint
    fit, on top of `motor`, a model with covariance; `held_out` runs only verify. Raises `InputError`.

    >>> import winch_friction as wf
    >>> found = wf.fit("a6vm215_generated", motor="mj4")
    >>> found.model.term_names[0], bool(found.rms < 5.0)
    ('motor_viscous', True)
    """
    if isinstance(data, (str, Path)):
        if isinstance(motor, FrictionModel):
            raise InputError("fit: for a supplier's table, motor= is the name of a motor-loss model, e.g. 'mj4'")
        return _fit_table(Path(data), motor, seed)
    if crane is None:
        raise InputError("fit: logged tests need a crane; pass crane=wf.load_crane(...)")
    return _fit_tests(list(data), crane, motor, list(held_out), seed)


def _fit_table(path: Path, name: str, seed: int) -> Fit:
    from winch_friction.identification.motor_identification import identify_motor, motor_seed
    from winch_friction.identification.supplier_file import read_supplier_table
    from winch_friction.records.strict_yaml import shipped

    table = read_supplier_table(shipped("suppliers", path, ".csv"))
    found = identify_motor(table, [name], chosen=name, with_complex=False, seed=seed)
    return Fit(motor_seed(found, path.stem, {}), float(found.chosen.fitted.rms), found)


def _fit_tests(tests: list[Any], crane: Crane, motor: FrictionModel | str, held_out: list[Any], seed: int) -> Fit:
    import numpy as np

    from winch_friction.identification.prior import load_unit_spread
    from winch_friction.identification.system_identification import identify_system, winch_seed
    from winch_friction.identification.verification import test_errors
    from winch_friction.records.model_file import load_model

    given = load_model(motor) if isinstance(motor, str) else motor
    found = identify_system(
        _read(tests, crane), crane, given.only("motor"), load_unit_spread(), held_out=_read(held_out, crane), seed=seed
    )
    errors = test_errors(found.joint.model, [test.curve for test in found.tests])
    squares = [float(np.mean((error.modelled - error.measured) ** 2)) for error in errors]
    return Fit(winch_seed(found, crane, "fitted", {}), float(np.sqrt(np.mean(squares))), found)


@checked
def check(runs: Runs, crane: Crane, model: FrictionModel | None = None) -> Check:
    """Whether runs can be this crane's, and which mistake would explain why not; a model judges more sharply.

    Returns `plausible`, `findings` (gravest first) and `summary()`. Raises `InputError`.

    >>> import winch_friction as wf
    >>> crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    >>> run = wf.simulate("ahc_55t_215", crane, model, duration=30.0).run
    >>> wf.check([run], crane, model).plausible
    True
    """
    from winch_friction.commissioning.commissioning import check as checked

    return Check(checked(_read(list(runs), crane), crane, model))


@checked
def gap(runs: Runs, crane: Crane, model: FrictionModel, *, holdout: float = 0.25, seed: int = 0) -> Gap:
    """Where runs and model disagree, which effect is missing, and the proof on runs that were locked away.

    `runs` are runs or files, two or more for a proof on a whole run; `holdout` is the share that is locked. Returns the
    verdict with `effects`, the repaired `model`, `summary()`, `plot()`, `to_html()`. Raises `InputError`.

    >>> import numpy as np, winch_friction as wf
    >>> crane, model = wf.load_crane("emps"), wf.load_model("emps_viscous")
    >>> truth = wf.load_model("emps_symmetric").with_values({"T_0": 0.0})  # has Coulomb friction, which the model lacks
    >>> def logged(k):
    ...     noise = np.random.default_rng(k).normal(0.0, 0.3, 3000)
    ...     time = 0.02 * np.arange(3000)
    ...     speed = 0.15 * np.sin(2 * np.pi * time / (6 + k)) * np.sin(2 * np.pi * time / 37 + k)
    ...     columns = {"time": time, "motor_speed": speed, "motor_torque": 0 * time, "hook_load": 0 * time}
    ...     drive = crane.inertia * np.gradient(speed, time) + wf.torque(truth, wf.from_frame(columns), crane) + noise
    ...     return wf.from_frame({**columns, "motor_torque": drive}, f"run {k}")
    >>> found = wf.gap([logged(k) for k in range(5)], crane, model)
    >>> found.verdict in ("missing_effect", "ambiguous")
    True
    >>> locked = found.content()["gap"]["holdout"]  # N m
    >>> bool(locked["after"] < 0.1 * locked["before"])
    True
    """
    from winch_friction.discrepancy.answer import GapOptions
    from winch_friction.discrepancy.workflow import find_gap

    return Gap(find_gap(_read(list(runs), crane), crane, model, GapOptions(holdout=holdout, seed=seed)))


def _read(runs: Sequence[Any], crane: Crane) -> list[Run]:
    from winch_friction.records.runs import read_run

    return [each if isinstance(each, Run) else read_run(each, crane) for each in runs]
