"""Sensors without noise, steps and jitter, as changes to a scenario."""

CLEAN = {"sensors.noise": False, "sensors.quantisation": False, "sensors.jitter": 0.0}
