"""The plant: hydraulics, motors, gear, drum, elastic wire and payload, as equations of motion and their integrator."""
