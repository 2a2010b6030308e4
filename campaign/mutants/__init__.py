"""Small semantic faults, one at a time in a copy of the package: do the tests notice (`make mutants`)?"""
