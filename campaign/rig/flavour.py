"""Flavours: how crane, test plan, instruments and logging differ from one data set to the next."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Flavour:
    """One way of testing and logging a winch."""

    name: str
    loads: tuple[float, ...]  # t on the hook of the constant-speed cycles, hook included
    displacements: tuple[float, ...]  # cm^3/rev
    plateaus: tuple[float, ...]  # share of the cycle's top speed, in order, positive hoisting
    ramp: float  # s from rest to the top speed
    smooth_ramps: bool
    top_speed: float  # rpm
    ahc_loads: tuple[float, ...]  # t
    ahc_displacements: tuple[float, ...]  # cm^3/rev, active motors
    irregular_sea: bool
    crane_moves: bool  # heave_velocity is logged and the load stays; else the winch moves the load
    pressure_noise: float  # bar
    noise_color: float  # AR(1) coefficient at 50 Hz
    pressure_step: float  # bar
    pulses: int  # encoder pulses per motor revolution
    speed_noise: float  # rad/s, added to the quantisation
    boost: tuple[float, ...]  # bar, one after the other over the runs
    temperatures: tuple[float, float]  # degC, spread over the runs
    days: float  # between first and last run
    layers: tuple[int, ...]
    channels: tuple[str, ...]  # optional channels that are logged
    jitter: float = 0.0  # s
    uniform_truth: bool = True
    pump_lag: float = 0.1  # s
    gas_pressure: float = 300.0  # bar
    gas_is_calculated: bool = False  # the log holds the PLC's polytropic law for the passive pressure
    pressure_is_late: bool = False  # signal_delay sits in the pressures, not in the speed
    wire_damping: float = 0.0  # N s/m of an elastic wire, below 1 its damping ratio; 0: rigid
    rate: float = 50.0  # Hz of the log
    units: str = "plant"  # plant: rpm, bar, cm^3/rev; si: no brackets


ALL = ("speed_reference", "hook_load", "oil_temperature", "wire_layer", "wire_out", "shaft_angle")

FLAVOURS = {
    flavour.name: flavour
    for flavour in (
        Flavour(
            "paper", (2, 77, 107, 2, 77, 107, 2, 77), (215, 215, 215, 164, 164, 164, 200, 146),
            (0.1, -0.1, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75, 1.0, -1.0), 4.0, False, 2000,
            (55, 55, 55, 30), (215, 160, 215, 215), False, False,
            0.3, 0.0, 0.15, 1024, 0.0, (25,), (32, 50), 2.0, (6,), ALL,
        ),
        Flavour(
            "slow_log", (15, 30, 55, 77, 107, 55, 30, 107), (120, 215, 146, 215, 164, 215, 102, 200),
            (1.0, -1.0, 0.6, -0.6, 0.3, -0.3, 0.12, -0.12, 0.05, -0.05), 2.5, True, 2300,
            (55, 55, 30, 77), (215, 160, 160, 215), True, True,
            0.4, 0.6, 0.15, 8192, 0.15, (18, 25, 32), (22, 58), 40.0, (6,), ALL, uniform_truth=False,
        ),
        Flavour(
            "quiet", (2, 55, 107, 30, 2, 77, 107, 55), (102, 102, 146, 146, 215, 215, 215, 180),
            (-0.2, 0.2, -0.8, 0.8, -0.4, 0.4, -0.08, 0.08, 1.0, -1.0, 0.05, -0.05), 3.0, True, 2200,
            (15, 55, 77, 100), (215, 215, 160, 180), True, False,
            0.2, 0.3, 0.05, 8192, 0.05, (20, 30), (25, 55), 60.0, (4, 5, 6), ALL, jitter=0.002, pump_lag=0.06,
        ),
        Flavour(
            "rough", (5, 40, 80, 100, 20, 60, 90, 107), (130, 130, 215, 146, 190, 160, 215, 215),
            (0.15, -0.3, 0.45, -0.6, 0.75, -0.9, 1.0, -0.1, 0.3, -0.75, 0.05, -0.05), 5.0, False, 1900,
            (20, 55, 90, 55), (160, 215, 215, 190), True, True,
            0.5, 0.8, 0.15, 1024, 0.1, (25, 15, 35), (20, 60), 20.0, (6,), ALL, jitter=0.003, uniform_truth=False,
            pressure_is_late=True, pump_lag=0.15,
        ),
        Flavour(
            "no_reference", (2, 30, 77, 107, 55, 2, 30, 77), (215, 164, 120, 200, 215, 146, 102, 215),
            (0.05, 0.1, 0.2, 0.4, 0.7, 1.0, -0.05, -0.1, -0.2, -0.4, -0.7, -1.0), 3.0, True, 2100,
            (55, 30, 77, 55), (215, 215, 180, 160), False, True,
            0.3, 0.5, 0.15, 2048, 0.1, (25, 20), (28, 52), 90.0, (5, 6), ALL[1:], gas_is_calculated=True,
        ),
        Flavour(
            "si_files", (10, 50, 100, 75, 25, 107, 2, 60), (215, 120, 180, 215, 146, 200, 164, 102),
            (0.5, -0.5, 0.1, -0.1, 1.0, -1.0, 0.25, -0.25, 0.05, -0.05, 0.75, -0.75), 6.0, True, 2000,
            (50, 50, 80, 25), (215, 170, 215, 200), False, False,
            0.25, 0.2, 0.1, 4096, 0.05, (25, 30, 20), (24, 56), 30.0, (5, 6), ALL, gas_pressure=280.0,
            gas_is_calculated=True, units="si",
        ),
        Flavour(
            "elastic_still", (2, 55, 107, 77, 30, 15, 107, 55), (215, 215, 215, 164, 164, 120, 146, 102),
            (0.1, -0.1, 0.3, -0.3, 0.6, -0.6, 1.0, -1.0, 0.05, -0.05), 5.0, True, 2000,
            (55, 30, 77, 55), (215, 160, 215, 190), False, False,
            0.3, 0.4, 0.15, 2048, 0.05, (25, 30), (25, 52), 30.0, (5, 6), ALL, wire_damping=0.06,
        ),
        Flavour(
            "elastic_sea", (5, 60, 100, 80, 35, 107, 20, 70), (215, 164, 215, 146, 130, 200, 215, 180),
            (1.0, -1.0, 0.5, -0.5, 0.2, -0.2, 0.08, -0.08, 0.75, -0.75), 4.0, True, 2100,
            (60, 20, 90, 55), (215, 215, 180, 160), True, True,
            0.35, 0.6, 0.15, 4096, 0.1, (25, 18, 32), (22, 56), 45.0, (6,), ALL, wire_damping=2.0e5, jitter=0.002,
        ),
        Flavour(
            "bare", (2, 55, 100, 77, 30, 107, 15, 60), (215, 164, 146, 215, 180, 200, 130, 215),
            (0.1, -0.1, 0.3, -0.3, 0.6, -0.6, 1.0, -1.0, 0.05, -0.05), 4.0, True, 2000,
            (55, 30, 77, 55), (215, 160, 215, 190), True, False,
            0.3, 0.4, 0.15, 2048, 0.05, (25, 20), (30, 50), 10.0, (6,), (),
        ),
    )
}  # fmt: skip
