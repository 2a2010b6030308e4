"""What goes wrong beside a machine, drawn at random, and whether the services stay safe (`make campaign-faults`)."""
