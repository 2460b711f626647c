"""Control conventions: the meaning of the actions of robots, and the conversion of motor commands to them and back."""
