"""Commissioning: can these runs be this crane's, and which mistake would explain why not?"""
