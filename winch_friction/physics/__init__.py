"""The physics alone: units, signals, the winch and the declared friction terms. Imports nothing above it."""
