"""Friction of a hydraulic winch: compensated online, learned online, identified offline, questioned always."""

__version__ = "0.1.0"
