"""What cameras of a scene see of a recording."""
