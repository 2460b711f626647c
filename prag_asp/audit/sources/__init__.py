"""The formats of problems that an audit can read, each in one file with a function `read`."""
