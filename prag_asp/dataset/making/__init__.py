"""A dataset being made: the run that writes it, where draws are looked at, and what others have made of it."""
