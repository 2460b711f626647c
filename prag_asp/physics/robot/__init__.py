"""The robots' kinematics, and the files from which PyBullet loads them."""
