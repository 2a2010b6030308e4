"""A model on a run or over speed: torque, what each term gives, derivatives, the friction curve."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from winch_friction.api.arguments import checked
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.model import FrictionModel, completed
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import Crane


@checked
def torque(model: FrictionModel, run: Run, crane: Crane, *, load: float | None = None) -> FloatArray:
    """Friction torque along a run, (n,) N m at the motor shaft, all motors; positive when it resists hoisting.

    The load comes from the run's `hook_load`, else from `load` in kg (the whole hanging mass). What the model says is
    wrong with the signals (its corrections) is taken out first; a delay shortens the run by what it shifts. Raises
    `InputError` for a channel that the model reads and the run lacks.

    >>> import winch_friction as wf
    >>> run = wf.from_frame({"time": [0.0, 0.1], "motor_speed [rpm]": [600.0, -600.0], "motor_torque": [0.0, 0.0]})
    >>> wf.torque(wf.load_model("emps_symmetric"), run, wf.load_crane("emps"), load=0.0).round(3)
    array([ 12803.507, -12809.837])
    """
    model, at, time = _points(model, run, crane, load)
    return np.array(np.broadcast_to(model.torque(at), (len(time),)), float)


@checked
def contributions(model: FrictionModel, run: Run, crane: Crane, *, load: float | None = None) -> Any:
    """What each term gives along a run: a DataFrame (n, terms) in N m over time; the columns add up to `torque`.

    >>> import winch_friction as wf
    >>> run = wf.from_frame({"time": [0.0, 0.1], "motor_speed [rpm]": [600.0, -600.0], "motor_torque": [0.0, 0.0]})
    >>> wf.contributions(wf.load_model("emps_symmetric"), run, wf.load_crane("emps"), load=0.0).columns.tolist()
    ['coulomb', 'viscous', 'torque_offset']
    """
    from winch_friction.physics.frames import library

    model, at, time = _points(model, run, crane, load)
    parts = model.contributions(at)
    frame = library("pandas", "desk").DataFrame(parts, index=time)
    frame.index.name = "time"
    frame.attrs["units"] = {"time": "s", **dict.fromkeys(parts, "N*m")}
    return frame


@checked
def jacobian(model: FrictionModel, run: Run, crane: Crane, *, load: float | None = None) -> FloatArray:
    """Partial derivatives of `torque` by the model's parameters, (n, parameters), in `model.parameter_names` order.

    >>> import winch_friction as wf
    >>> run = wf.from_frame({"time": [0.0, 0.1], "motor_speed [rpm]": [600.0, -600.0], "motor_torque": [0.0, 0.0]})
    >>> wf.jacobian(wf.load_model("emps_symmetric"), run, wf.load_crane("emps"), load=0.0).round(2)
    array([[  1.  ,  62.83,   1.  ],
           [ -1.  , -62.83,   1.  ]])
    """
    model, at, _ = _points(model, run, crane, load)
    return model.jacobian(at)


@checked
def friction_curve(
    model: FrictionModel,
    crane: Crane,
    *,
    load: float = 0.0,
    displacement: float | None = None,
    speed: Sequence[float] | FloatArray | None = None,
) -> Any:
    """Friction over speed at one load, turning steadily: a DataFrame over `speed` in rad/s.

    Columns: `torque` N m at the motor shaft, `std` N m (NaN where the model has no covariance), `pressure` Pa (the drop
    that carries load and friction), and each term. `load` kg, `displacement` m^3/rad per motor (default: the largest),
    `speed` rad/s (default hoisting, 5 ... 2000 rpm or as far as the crane can run). Raises `InputError`.

    >>> import winch_friction as wf
    >>> crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    >>> curve = wf.friction_curve(model, crane, load=55e3)
    >>> curve.attrs["units"]["torque"], bool(curve["torque"].iloc[0] > curve["torque"].min())
    ('N*m', True)
    """
    from winch_friction.physics.frames import library
    from winch_friction.physics.winch.model_curve import model_curve

    found = model_curve(model, crane, load=load, displacement=displacement, speed=speed)
    columns = {"torque": found.torque, "std": found.std, "pressure": found.pressure, **found.parts}
    frame = library("pandas", "desk").DataFrame(columns, index=found.speed)
    frame.index.name = "speed"
    frame.attrs["units"] = {"speed": "rad/s", **dict.fromkeys(columns, "N*m"), "pressure": "Pa"}
    return frame


def _points(model: FrictionModel, run: Run, crane: Crane, load: float | None) -> tuple[FrictionModel, Any, FloatArray]:
    """The model as it is on this crane, operating points and times of the run without the errors that it knows of."""
    from winch_friction.physics.corrections import corrected
    from winch_friction.physics.winch.crane import run_drum_torque
    from winch_friction.physics.winch.operating_point import run_operating_points

    if "hook_load" not in run and load is None:
        raise InputError(f"{run.name}: no column 'hook_load'; give load= in kg, the whole hanging mass")
    right, machine = corrected(run, crane, model)
    drum_torque = run_drum_torque(right, machine, float("nan") if load is None else float(load))
    return completed(model, crane), run_operating_points(right, machine, drum_torque=drum_torque), right.time
