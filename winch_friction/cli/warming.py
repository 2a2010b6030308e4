"""Compiled code, made once and kept: what `make setup` and `winch-friction doctor` do so that no first start waits.

An estimator's filter takes two seconds to compile, the simulated plant six, and the laws that a search for a missing
effect compares seven; numba's own start, half a second, stays.
"""

import sys
import time
from collections.abc import Callable, Iterator


def warmed() -> Iterator[tuple[str, float]]:
    """What is compiled, and the seconds that it took to compile or to read, one after the other.

    Raises `ImportError` where numba is not installed, `OSError` or `RuntimeError` where nothing can be kept.
    """
    for name, make in (("estimator's filter", _filter), ("simulated plant", _plant), ("laws of a search", _laws)):
        begin = time.perf_counter()
        make()
        yield name, time.perf_counter() - begin


def _filter() -> None:
    from winch_friction.estimation.kernels import kernels

    kernels()


def _plant() -> None:
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model
    from winch_friction.simulation import Simulator, load_scenario

    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    Simulator(load_scenario("ahc_irregular"), crane, model).step(0.0)


def _laws() -> None:
    from winch_friction.discrepancy.candidates.families import outlines
    from winch_friction.discrepancy.catalogue import all_candidates
    from winch_friction.physics.friction.compiled import compiled

    laws = [candidate.term for candidate in all_candidates() if candidate.term is not None]
    for group_count in (1, 2):
        for term in (*laws, *outlines()):
            compiled((term,), group_count, ()).vector_columns  # noqa: B018 - it is made by being asked for


def main(say: Callable[[str], object] = print) -> int:
    """Fill the cache; 0 also where that cannot be done, for all works without, only slower."""
    try:
        for name, seconds in warmed():
            say(f"{name}: {seconds:.1f} s")
    except (ImportError, OSError, RuntimeError) as error:
        say(f"compiled code is not kept ({error}); it works without, slower")
    return 0


if __name__ == "__main__":
    sys.exit(main())
