"""The truth's friction as a C function, compiled from the model's declared terms and called from the plant by address.

The plant's own compiled code then does not depend on the model and stays in numba's cache from one process to the next.
"""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from winch_friction.physics.friction.compiled import CompiledTerms
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.simulation.generated import c_function, python_source
from winch_friction.simulation.plant.point import GROUPS, POINT_LENGTH


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


def _call_by_address(count: int) -> Any:
    array = types.Array(types.float64, 1, "C")

    def typed(typing_context: Any, address: Any, *arrays: Any) -> Any:
        signature = types.float64(types.int64, *([array] * count))

        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            pointers = [
                context.make_array(kind)(context, builder, value).data
                for kind, value in zip(sig.args[1:], args[1:], strict=True)
            ]
            function_type = ir.FunctionType(ir.DoubleType(), [pointer.type for pointer in pointers])
            return builder.call(builder.inttoptr(args[0], function_type.as_pointer()), pointers)

        return signature, generate

    return typed


_three = _call_by_address(3)
_four = _call_by_address(4)


def _torque(typing_context: Any, address: Any, x: Any, theta: Any, z: Any) -> Any:
    """Call the torque function at `address` with (x, theta, z)."""
    return _three(typing_context, address, x, theta, z)


def _rates(typing_context: Any, address: Any, x: Any, theta: Any, z: Any, out: Any) -> Any:
    """Call the state rate function at `address`; fills `out` with gain and decay of each state."""
    return _four(typing_context, address, x, theta, z, out)


friction_torque: Any = intrinsic(_torque)
friction_state_rates: Any = intrinsic(_rates)
