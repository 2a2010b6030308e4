"""Many recordings of many cranes: what to work on, what is done, what it says about each crane and about the fleet."""
