"""The commands, in one file each: they parse options, call the package, and print results."""
