"""The page of a logic program: its answer sets, with the exact number that contain each atom."""
