"""The identification campaign: from generated tables and simulated logs to figures against the bars.

    python -m campaign.identification [--quick] [--seeds 20] [--out docs/campaign_identification.md]

Seeds start at 5000; development used seeds below 1000. About ten minutes on one core.
"""

import argparse
import os
import time
from pathlib import Path
from typing import Any

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")  # before numpy: one core

from campaign.commit import commit  # noqa: E402
from campaign.identification_crane import study  # noqa: E402
from campaign.identification_motors import LOSSES, MOTORS, fitters, held_out, recovery  # noqa: E402
from campaign.identification_table import page  # noqa: E402
from winch_friction.records.atomic import write_text  # noqa: E402

FIRST_SEED = 5000


def main() -> None:
    """Run and write the page."""
    options = arguments()
    started = time.perf_counter()
    restarts, limit = (1, 2000) if options.quick else (3, 20000)
    tables = list(LOSSES)[:1] if options.quick else list(LOSSES)
    results: dict[str, Any] = {
        "commit": commit(),
        "recovery": [recovery(motor) for motor in MOTORS],
        "fitters": [row for loss in tables for motor in MOTORS for row in fitters(motor, loss, restarts, limit)],
        "held_out": {motor: held_out(motor) for motor in MOTORS},
        "cranes": [],
    }
    print(f"motors done after {time.perf_counter() - started:.0f} s", flush=True)
    for seed in range(FIRST_SEED, FIRST_SEED + (2 if options.quick else options.seeds)):
        results["cranes"].append(study(seed, restarts))
        print(f"seed {seed} done after {time.perf_counter() - started:.0f} s", flush=True)
    results["seconds"] = time.process_time()
    results["wall"] = time.perf_counter() - started
    results["command"] = "python -m campaign.identification" + (" --quick" if options.quick else "")
    print(write_text(options.out, page(results)))


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--quick", action="store_true", help="a smoke version, under a minute")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--out", type=Path, default=None)
    options = parser.parse_args()
    name = "out/campaign_identification_quick.md" if options.quick else "docs/campaign_identification.md"
    options.out = options.out or Path(name)
    return options


if __name__ == "__main__":
    main()
