"""Let the robots execute tasks in a dynamic simulation."""
