"""What is going on at the winch, from the topics of running nodes or of a bag, for `watch` and `dashboard`.

A frame is plain data: new points of each signal, [time s, value] in the unit that people read, and the latest
diagnostics.
"""

from typing import Any

from winch_friction.physics.channels import RPM

JOINT = "sensor_msgs/msg/JointState"
# topic below the winch's namespace -> its type; /diagnostics is shared by all
TOPICS = {
    "winch/joint_states": JOINT, "winch/reference": JOINT, "compensator/friction_torque": JOINT,
    "estimator/friction_torque": JOINT, "simulator/truth": JOINT, "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}  # fmt: skip
# signal -> what it is and its unit
SIGNALS = {
    "speed": "motor speed [rpm]", "reference": "commanded speed [rpm]", "feedforward": "feedforward [N·m]",
    "learned": "friction by the learned model [N·m]", "truth": "true friction, simulated [N·m]",
    "error": "position error of the load [mm]",
}  # fmt: skip
SPEEDS = {"winch/joint_states": "speed", "winch/reference": "reference"}  # topic of joints -> signal
MOTOR = "winch_motor"  # the joint's usual name
SPACING = 0.05  # s between the points of a signal: 20 Hz is more than an eye follows


class Telemetry:
    """Takes messages as they come, gives frames.

    `joint` carries the speed; '' stands for the motor's usual name, else the first there is, and that is said. Of the
    diagnostics, which all winches share, those of the nodes in `namespace` are taken, without one all.
    """

    def __init__(self, joint: str = "", namespace: str = "") -> None:
        self._joint, self._notes = joint, dict[str, str]()
        self._space = f"{namespace.strip('/')}/" if namespace.strip("/") else ""
        self._points: dict[str, list[list[float]]] = {name: [] for name in SIGNALS}
        self._last: dict[str, float] = {}
        self._status: dict[str, dict[str, Any]] = {}
        self.time = float("nan")

    def take(self, topic: str, message: Any, receipt: float = float("nan")) -> None:
        """One message of a topic of `TOPICS`, from rclpy or from a bag; `receipt` s dates one without a stamp."""
        if topic == "/diagnostics":
            for each in (s for s in message.status if s.name.startswith(self._space)):
                self._status[each.name] = {
                    "level": each.level[0] if isinstance(each.level, bytes) else int(each.level),
                    "message": each.message,
                    "hardware": each.hardware_id,
                    "values": {pair.key: pair.value for pair in each.values},
                }  # fmt: skip
            return
        header = getattr(message, "header", None)  # none: a plain number of a simple bridge
        self.time = receipt if header is None else header.stamp.sec + 1e-9 * header.stamp.nanosec
        if topic in SPEEDS and header is not None:
            self._add(SPEEDS[topic], self._speed(topic, message) / RPM)
            return
        for signal, value in _values(topic, message):
            self._add(signal, value)

    def _speed(self, topic: str, message: Any) -> float:
        """The speed of the joint that is asked for, rad/s; NaN without it."""
        names, wanted = list(message.name), self._joint or MOTOR
        there = ", ".join(f"'{name}'" for name in names)
        self._notes.pop(topic, None)
        if wanted in names:
            return _entry(message.velocity, names.index(wanted))
        if self._joint:
            self._notes[topic] = f"no joint '{wanted}', and no speed of it, among {there or 'none'}"
            return float("nan")
        if names:
            self._notes[topic] = f"the speed is of joint '{names[0]}' of {there}: name the motor's with --joint"
        return _entry(message.velocity, 0)

    def _add(self, signal: str, value: float) -> None:
        last = self._last.get(signal, float("-inf"))
        if value == value and (self.time - last >= SPACING or self.time < last):
            self._last[signal] = self.time
            self._points[signal].append([round(self.time, 4), float(f"{value:.6g}")])

    def frame(self) -> dict[str, Any]:
        """What came since the last frame, the latest diagnostics, and what is to be said of a topic."""
        points = {name: values for name, values in self._points.items() if values}
        self._points = {name: [] for name in SIGNALS}
        return {"time": self.time if self.time == self.time else None, "points": points, "status": self._status,
                "notes": list(self._notes.items())}  # fmt: skip


def _values(topic: str, message: Any) -> list[tuple[str, float]]:
    if not hasattr(message, "header"):
        return [(SPEEDS[topic], float(message.data) / RPM)] if topic in SPEEDS else []
    if topic == "simulator/truth":
        load = list(message.name).index("load") if "load" in message.name else None
        error = [("error", 1e3 * float(message.position[load]))] if load is not None else []
        return [("truth", _entry(message.effort, 0)), *error]
    return [("feedforward" if topic.startswith("compensator") else "learned", _entry(message.effort, 0))]


def _entry(values: Any, index: int) -> float:
    return float(values[index]) if index < len(values) else float("nan")


def estimates(status: dict[str, Any]) -> list[dict[str, Any]]:
    """The estimator's parameters from its diagnostics: name, value, std, status."""
    values: dict[str, str] = next(
        (s["values"] for name, s in status.items() if name.endswith("estimator: parameters")), {}
    )
    names = [key for key in values if f"{key} std" in values]
    return [
        {"parameter": n, "value": float(values[n]), "std": float(values[f"{n} std"]),
         "status": values.get(f"{n} status", "")}
        for n in names
    ]  # fmt: skip


def faults(status: dict[str, Any]) -> list[str]:
    """Every diagnostic that is not in order, in words."""
    levels = {1: "warning", 2: "error", 3: "stale"}
    return [f"{levels[s['level']]}: {name}: {s['message']}" for name, s in status.items() if s["level"] in levels]


def inputs(status: dict[str, Any]) -> list[dict[str, Any]]:
    """Rate and age of every input, as the compensator (else the estimator) says."""
    found: dict[str, str] = next((s["values"] for node in ("compensator", "estimator") for name, s in status.items()
                  if name.endswith(f"{node}: inputs")), {})  # fmt: skip
    topics = [key.removesuffix(" rate") for key in found if key.endswith(" rate")]
    return [{"input": t, "rate": float(found[f"{t} rate"]), "age": float(found.get(f"{t} age", "nan"))} for t in topics]


def state(status: dict[str, Any]) -> list[tuple[str, str]]:
    """One line per part of every node that has a state: its name and what it says."""
    return [(name, s["message"]) for name, s in status.items() if not name.endswith(("inputs", "parameters"))]
