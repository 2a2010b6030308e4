"""The EMPS benchmark (Janot, Gautier, Brunot 2019, nonlinear benchmark collection) as a run.

A ball-screw drive, measured: its motion is written as rotation (1 m = 1 rad, 1 N = 1 N m), so that position becomes
the shaft's angle and force the motor's torque. The authors' file gives the controller's output in volts; 35.1507 N/V
makes it the force that they identify with.
"""

from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run

FORCE_GAIN = 35.1507  # N/V, `gtau` of the benchmark
CUTOFF = 100.0  # Hz, of the benchmark's Butterworth filter
_ORDER = 4
_NEEDED = ("t", "qm", "qg", "vir")


def read_emps(path: Path | str, causal: bool = False) -> Run:
    """The benchmark's DATA_EMPS.mat as a run of an electric drive without load (crane `emps`).

    `motor_speed` is the position's central difference after a zero-phase 100 Hz Butterworth filter, as the benchmark's
    authors do; with `causal` the backward difference after the one-way filter, as a drive would have it live (some 5 ms
    late). `motor_torque` is unfiltered. `speed_reference` is the reference position's difference, unfiltered.
    Raises `InputError` for a file that is not the benchmark's.
    """
    path = Path(path)
    data = _variables(path)
    time = data["t"]
    period = float(np.median(np.diff(time)))
    speed = _causal_speed(data["qm"], period) if causal else _smooth_speed(data["qm"], period)
    columns = {
        "time": time,
        "motor_speed": speed,
        "speed_reference": np.gradient(data["qg"], period),
        "motor_torque": FORCE_GAIN * data["vir"],
        "shaft_angle": data["qm"],
    }
    source = "EMPS benchmark, A. Janot, M. Gautier, M. Brunot (2019), nonlinear benchmark collection"
    filtering = f"{'causal' if causal else 'zero-phase'} Butterworth, order {_ORDER}, {CUTOFF:g} Hz"
    return Run(name=path.name, columns=columns, metadata={"source": source, "speed": filtering})


def _variables(path: Path) -> dict[str, FloatArray]:
    from scipy.io import loadmat

    if not path.is_file():  # scipy speaks of another thing
        raise InputError(f"{path}: no such file")
    try:
        content: dict[str, Any] = loadmat(path)
    except Exception as error:  # scipy raises what its parser meets
        raise InputError(f"{path}: not a readable MATLAB file ({str(error)[:80]})") from error
    missing = [name for name in _NEEDED if name not in content]
    if missing:
        raise InputError(f"{path}: variables {', '.join(missing)} are missing; expected the benchmark's DATA_EMPS.mat")
    data = {name: np.asarray(content[name], dtype=float).ravel() for name in _NEEDED}
    if len({len(values) for values in data.values()}) > 1 or not all(np.isfinite(v).all() for v in data.values()):
        raise InputError(f"{path}: {', '.join(_NEEDED)} must be finite and of one length")
    return data


def _filter(period: float) -> Any:
    from scipy.signal import butter

    return butter(_ORDER, CUTOFF * 2.0 * period, output="ba")


def _smooth_speed(position: FloatArray, period: float) -> FloatArray:
    from scipy.signal import filtfilt

    return np.gradient(filtfilt(*_filter(period), position), period)


def _causal_speed(position: FloatArray, period: float) -> FloatArray:
    from scipy.signal import lfilter, lfilter_zi

    b, a = _filter(period)
    smooth, _ = lfilter(b, a, position, zi=lfilter_zi(b, a) * position[0])
    return np.diff(smooth, prepend=smooth[0]) / period
