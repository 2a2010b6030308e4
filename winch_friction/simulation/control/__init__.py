"""The winch controller: active heave compensation on either drive, and the open pump command of normal mode."""
