"""Formats of problems that an audit reads, each in one file with a function `read`."""
