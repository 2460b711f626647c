"""The generation of a dataset: the run that writes it, executors that validate draws, and parts of other machines."""
