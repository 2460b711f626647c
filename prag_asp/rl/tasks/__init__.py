"""The tasks of an environment, their sources, and the initial states of episodes."""
