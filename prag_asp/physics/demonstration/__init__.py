"""Tasks performed by the robot in a world with forces."""
