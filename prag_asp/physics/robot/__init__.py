"""The arms of the robots: their kinematics, and the files that PyBullet loads."""
