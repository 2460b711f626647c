"""The tasks of an environment and their sources, and the initial states of episodes."""
