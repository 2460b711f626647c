"""Generate a dataset: the run that writes it, the executors that validate draws, and the parts of other machines."""
