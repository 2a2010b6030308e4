"""The truth's friction as a C function, compiled from the model's declared terms and called from the plant by address.

The plant's own compiled code then does not depend on the model and stays in numba's cache from one process to the next.
"""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from winch_friction.physics.friction.compiled import CompiledTerms
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.friction.sources import python_source
from winch_friction.simulation.generated import c_function
from winch_friction.simulation.plant.point import GROUPS, POINT_LENGTH


class Terms(NamedTuple):
    """Addresses of what the model's friction is computed with; `rates` is 0 for a model without states."""

    torque: int
    rates: int
    theta: int
    z: int
    gains: int


@dataclass(frozen=True)
class FrictionKernel:
    """Addresses of the torque and of the state rates (0 without states), and the states at the start."""

    torque_address: int
    rates_address: int
    initial_states: tuple[float, ...]
    keep_alive: tuple[Any, ...] = field(repr=False, default=())


def friction_kernel(model: FrictionModel) -> FrictionKernel:
    """The compiled friction of a model; models of the same terms and constants share it."""
    return _kernel(model.compile(GROUPS))


@lru_cache(maxsize=64)
def _kernel(functions: CompiledTerms) -> FrictionKernel:
    sizes = POINT_LENGTH, len(functions.parameters), len(functions.initial_states)
    torque = _torque_function(functions, sizes)
    rates = _rates_function(functions, sizes) if functions.initial_states else None
    return FrictionKernel(
        torque.address,
        rates.address if rates else 0,
        functions.initial_states,
        (functions, torque, rates),
    )


def _torque_function(functions: CompiledTerms, sizes: tuple[int, int, int]) -> Any:
    """The torque as a C function of pointers to x, theta and z."""
    source = python_source(functions.scalar_torque, "kernel")
    wrapper = f"def torque(x, theta, z):\n    return 1.0 * kernel({_tuples(sizes)})\n"
    return c_function("torque", source + wrapper, 3)


def _rates_function(functions: CompiledTerms, sizes: tuple[int, int, int]) -> Any:
    """The states' gains and decays as a C function that fills its fourth pointer."""
    source = python_source(functions.scalar_state_rates, "kernel")
    stores = "".join(f"    out[{k}] = r[{k}]\n" for k in range(2 * sizes[2]))
    wrapper = f"def rates(x, theta, z, out):\n    r = kernel({_tuples(sizes)})\n{stores}    return 0.0\n"
    return c_function("rates", source + wrapper, 4)


def _tuples(sizes: tuple[int, int, int]) -> str:
    parts = (
        "(" + "".join(f"{name}[{k}], " for k in range(size)) + ")"
        for name, size in zip(("x", "theta", "z"), sizes, strict=True)
    )
    return ", ".join(parts)


_POINTER = ir.DoubleType().as_pointer()


def _call(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Call the C function at the first argument; a tuple is put on the stack, an address is a pointer to doubles."""
    pointers = [
        builder.inttoptr(value, _POINTER)
        if isinstance(kind, types.Integer)
        else builder.bitcast(cgutils.alloca_once_value(builder, value), _POINTER)
        for kind, value in zip(signature.args[1:], arguments[1:], strict=True)
    ]
    function_type = ir.FunctionType(ir.DoubleType(), [_POINTER] * len(pointers))
    return builder.call(builder.inttoptr(arguments[0], function_type.as_pointer()), pointers)


def _torque(typing_context: Any, address: Any, x: Any, theta: Any, z: Any) -> Any:
    """Call the torque function at `address` with the tuple x and what lies at the addresses theta and z."""
    return types.float64(address, x, theta, z), _call


def _rates(typing_context: Any, address: Any, x: Any, theta: Any, z: Any, out: Any) -> Any:
    """Call the state rate function at `address`; fills what lies at `out` with gain and decay of each state."""
    return types.float64(address, x, theta, z, out), _call


friction_torque: Any = intrinsic(_torque)
friction_state_rates: Any = intrinsic(_rates)
