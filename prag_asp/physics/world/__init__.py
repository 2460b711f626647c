"""Bodies in PyBullet: kinematic and dynamic simulation, collisions and static stability."""
