"""From a measured run to what every candidate reads: smooth signals, regimes, the base model's balance."""
