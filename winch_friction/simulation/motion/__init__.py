"""What moves the winch: the sea at the crane tip, and the operator's profile."""
