"""What the plant has and the model lacks, as physical quantities; all zero: nothing is missing."""

from typing import NamedTuple


class Hidden(NamedTuple):
    """Strengths of the effects inside the plant, SI; the default of each means 'absent'."""

    viscosity: float = 0.0  # 1: viscous terms follow the oil's viscosity fully
    stribeck: float = 0.0  # extra rise, as a multiple of the crane's own
    stribeck_speed: float = 20.0  # rad/s
    presliding_angle: float = 0.0  # rad of shaft for one e-fold of the bristles
    dwell_gain: float = 0.0  # relative growth of the break-away level
    dwell_angle: float = 1.0  # rad of sliding that rejuvenates the contact
    dwell_rate: float = 0.3  # 1/s
    asymmetry: float = 0.0  # share of T_d/i
    load_loss: float = 0.0  # share of T_d/i
    radius_step: float = 0.0  # relative error of the rope radius on the deeper layer
    sheave: float = 0.0  # share of T_d/i
    coulomb_drift: float = 0.0  # relative growth of K4 over the dates of the data set
    low_displacement: float = 0.0  # N m / Pa per motor
    turbulence: float = 0.0  # share of the K2 term at 2000 rpm and full displacement
    turbulence_exponent: float = 2.0
    notch: float = 0.0  # N m per motor at 400 rpm, 200 bar, full displacement
    churning: float = 0.0  # N m per motor at 2000 rpm
    churning_exponent: float = 2.0
    mixed: float = 0.0  # N m / Pa^2 per motor
    leakage: float = 0.0  # m^3/s/Pa for the whole loop at 40 degC, beyond what the controller knows
    line_drop: float = 0.0  # Pa/(m^3/s)^2 between transducer and motors
    case: float = 0.0  # N m / Pa per motor
    gas_time: float = 0.0  # s, thermal time constant of the accumulator
    gas_warm: float = 0.0  # relative excess temperature at the start of a run
    inertia: float = 0.0  # kg m^2
    air: float = 0.0  # volume share at atmospheric pressure
    ripple: float = 0.0  # share of T_d/i
    ripple_order: float = 1.0  # periods per revolution of the motor shaft
    brake: float = 0.0  # N m per motor
    tare: float = 0.0  # kg that the load signal does not contain
    tare_wire: float = 0.0  # share of the wire's weight that the load signal does not contain
    pressure_offset: float = 0.0  # Pa
    pressure_scale: float = 0.0  # relative
    delay: float = 0.0  # s, of the speed signal
    swivel: float = 0.0  # m^3/rad
    # outside any catalogue
    wire_drag: float = 0.0  # N m per 100 m of wire
    seal_grip: float = 0.0  # N m per 20 K away from 40 degC
    sector: float = 0.0  # N m within a sector of the drum
    run_drift: float = 0.0  # N m at the start of a run, fading in 60 s
    pressure_memory: float = 0.0  # N m per 100 bar of the pressure of the last half minute
    root_speed: float = 0.0  # N m at 100 rad/s, growing with the root of the speed
    speed_bump: float = 0.0  # N m at 90 rad/s, 12 rad/s wide
    jerkiness: float = 0.0  # N m per 10 rad/s^2 of the acceleration that is asked for, whatever its sign
    layer_scrub: float = 0.0  # N m per wire layer below the sixth
