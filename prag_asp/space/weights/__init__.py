"""The weights of tasks for sampling."""
