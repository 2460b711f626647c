"""A campaign of mutants: inputs that are nearly right, given to the commands; see `python -m tests.fuzz --help`."""
