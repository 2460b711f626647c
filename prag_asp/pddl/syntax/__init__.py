"""PDDL files as syntax trees whose nodes carry line numbers."""
