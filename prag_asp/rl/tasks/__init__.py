"""Where the tasks of an environment come from, and with which of their subgoals an episode begins."""
