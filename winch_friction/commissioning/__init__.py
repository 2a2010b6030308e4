"""Commissioning: can these runs be this crane's, and which mistake would explain why not?

`check.quick_check` is the part below a second that the other verbs ask first; `commissioning.check` is all of it.
"""
