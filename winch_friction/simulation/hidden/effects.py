"""The declarations. Sizes are those of docs/discrepancy.md; each changes the physics where it arises."""

from winch_friction.physics.channels import BAR, CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.simulation.hidden.catalogue import DEGREE, MONTH, WEAR_EPOCH, Target, effect


# -- friction torques
@effect("stribeck", "111 N m at 55 t, e-fold 229 rpm")
def _stribeck(t: Target, size: float) -> None:
    t.torque["stribeck_share"] = 155e-7 * size
    t.torque["stribeck_torque"] = 0.562 * size
    t.torque["stribeck_speed"] = 24.0


@effect("dwell_stiction", "15 % above the running friction, 0.2 1/s")
def _dwell(t: Target, size: float) -> None:
    t.torque["dwell_share"] = 0.15 * size
    t.torque["dwell_rate"] = 0.2
    t.torque["dwell_angle"] = 1.0


@effect("gear_asymmetry", "0.6 % of T_d/i between hoisting and lowering", either_sign=True)
def _asymmetry(t: Target, size: float) -> None:
    t.torque["gear_asymmetry"] = 0.006 * size


@effect("gear_load_loss", "4.5 % of T_d/i", either_sign=True)
def _gear_loss(t: Target, size: float) -> None:
    t.torque["gear_loss"] = 0.045 * size


@effect("sheave_bending", "3 % of the wire's tension")
def _sheave(t: Target, size: float) -> None:
    t.torque["sheave_loss"] = 0.03 * size


@effect("wear_drift", "4 N m per motor and month of Coulomb friction", either_sign=True)
def _wear(t: Target, size: float) -> None:
    t.torque["wear_rate"] = 4.0 / MONTH * size
    t.torque["wear_epoch"] = WEAR_EPOCH


@effect("low_displacement_loss", "100 N m between 145 and 215 cm^3/rev at 100 bar")
def _low_displacement(t: Target, size: float) -> None:
    t.torque["low_displacement"] = 2.74e-6 * size


@effect("port_turbulence", "22 % of the turbulent losses, exponent 2.4", either_sign=True)
def _turbulence(t: Target, size: float) -> None:
    t.torque["turbulence"] = 0.22 * 64.9 * size
    t.torque["turbulence_exponent"] = 2.4


@effect("notch_loss", "6 N m per motor at 200 bar and 400 rpm")
def _notch(t: Target, size: float) -> None:
    t.torque["notch"] = 1.66e-7 * size


@effect("churning", "3 N m per motor at 2000 rpm, exponent 1.9")
def _churning(t: Target, size: float) -> None:
    t.torque["churning"] = 3.0 * size
    t.torque["churning_exponent"] = 1.9


@effect("high_pressure_mixed", "14 N m per motor at 350 bar")
def _mixed(t: Target, size: float) -> None:
    t.torque["mixed"] = 14.0 / (350.0 * BAR) ** 2 * size


@effect("case_pressure", "5 bar at 180 bar of p_A + p_B", either_sign=True)
def _case(t: Target, size: float) -> None:
    t.torque["case"] = 9.5e-7 * size


@effect("torque_ripple", "1 % of T_d/i, once per motor revolution", either_sign=True)
def _ripple(t: Target, size: float) -> None:
    t.torque["ripple_share"] = 0.01 * size
    t.torque["ripple_order"] = 1.0


@effect("brake_drag", "3 N m per motor")
def _brake(t: Target, size: float) -> None:
    t.torque["brake"] = 3.0 * size


# -- the plant itself
@effect("viscosity_temperature", "viscous terms follow Walther's viscosity")
def _viscosity(t: Target, size: float) -> None:
    t.plant["viscosity_share"] = size


@effect("presliding", "2 deg of shaft")
def _presliding(t: Target, size: float) -> None:
    t.plant["presliding"] += 2.0 * DEGREE * size


@effect("layer_radius", "the wire lies one layer lower than the log says", either_sign=True)
def _layer(t: Target, size: float) -> None:
    layer = int(t.plant["layer"])
    neighbour = layer - 2 if layer > 1 else layer
    radius = t.plant["radius"] + size * (t.layer_radii[neighbour] - t.plant["radius"])
    t.plant["metres_per_radian"] *= radius / t.plant["radius"]
    t.plant["radius"] = radius


@effect("slip_leakage", "1.4e-11 m^3/s/Pa per motor, about 50 rpm at 130 bar")
def _slip(t: Target, size: float) -> None:
    t.plant["leakage"] += 1.4e-11 * size


@effect("line_pressure_drop", "3.5 bar at 1290 l/min")
def _line(t: Target, size: float) -> None:
    t.plant["line_resistance"] += 3.5 * BAR / 0.0215**2 * size


@effect(
    "accumulator_thermal", "adiabatic gas with 60 s to the wall, starting 2 % warm; the PLC calculates polytropically"
)
def _thermal(t: Target, size: float) -> None:
    t.plant["calculated_exponent"] = t.plant["gas_exponent"]
    t.plant["gas_exponent"] += (1.4 - t.plant["gas_exponent"]) * min(size, 1.0)
    t.plant["gas_time"] = 60.0
    t.plant["gas_start"] = 1.0 + 0.02 * size


@effect("inertia_error", "10 % more inertia at the shaft", either_sign=True)
def _inertia(t: Target, size: float) -> None:
    t.plant["inertia"] *= 1.0 + 0.1 * size


@effect("entrained_air", "1 % free air")
def _air(t: Target, size: float) -> None:
    t.plant["air"] += 0.01 * size


@effect("tare_load", "2 t: 0.8 t of hook and the wire's weight", either_sign=True)
def _tare(t: Target, size: float) -> None:
    t.plant["wire_mass"] = 24.5 * size
    more = (800.0 + 24.5 * float(t.plant["wire_out"])) * size
    if float(t.plant["mass"]) + more <= 0.0:
        raise InputError(
            f"effect 'tare_load': size {size:g} takes {-more:.0f} kg from a load of {float(t.plant['mass']):.0f} kg; "
            "take a smaller size or a larger load"
        )
    t.plant["mass"] += more


# -- the sensors
@effect("pressure_offset", "1.5 bar on the driven group's pressure A", either_sign=True)
def _offset(t: Target, size: float) -> None:
    for row in t.sensor("main.pressure_a", "active.pressure_a"):
        row["offset"] += 1.5 * BAR * size


@effect("pressure_scale", "0.5 % of the driven group's pressures", either_sign=True)
def _scale(t: Target, size: float) -> None:
    for row in t.sensor("main.pressure_a", "active.pressure_a", "main.pressure_b", "active.pressure_b"):
        row["scale"] *= 1.0 + 0.005 * size


@effect("signal_delay", "50 ms on the speed")
def _delay(t: Target, size: float) -> None:
    for row in t.sensor("motor_speed", "shaft_angle"):
        row["delay"] += 0.05 * size


@effect("swivel_offset", "1 cm^3/rev of the driven group's displacement feedback", either_sign=True)
def _swivel(t: Target, size: float) -> None:
    for row in t.sensor("main.displacement", "active.displacement"):
        row["offset"] += 1.0 * CM3_PER_REV * size
