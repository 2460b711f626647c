"""Bodies in PyBullet: kinematic and dynamic simulators, collisions and static stability."""
