"""Bodies in PyBullet: simulators without and with forces, what collides, and what stands."""
