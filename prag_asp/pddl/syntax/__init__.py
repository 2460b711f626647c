"""Files of PDDL as syntax trees that know their lines."""
