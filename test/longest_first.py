"""Which files begin first: on several workers, a long one that begins last lets the others wait."""

# processor seconds of each on the machine of docs/benchmarks.md, of about 650 in all
SECONDS = {
    "discrepancy/test_again.py": 90,
    "discrepancy/test_workflow.py": 80,
    "commissioning/test_commissioning.py": 60,
    "bench/test_benchmarks.py": 60,
    "browser/test_report_pages.py": 60,
    "discrepancy/test_own_simulation.py": 30,
    "discrepancy/test_gap_cli.py": 30,
    "discrepancy/test_standing.py": 30,
    "campaign_rig/test_rig.py": 20,
    "fleet/test_fleet_verb.py": 18,
    "importing/test_import_verb.py": 16,
    "discrepancy/test_ties.py": 15,
    "docs/test_snippets.py": 14,
    "discrepancy/test_next_experiment.py": 13,
    "discrepancy/test_proposals.py": 13,
    "test_hops.py": 12,
    "discrepancy/test_mixed_laws.py": 11,
    "discrepancy/test_wire_mode.py": 11,
    "simulation/test_generated_cache.py": 9,
}
