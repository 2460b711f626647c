"""The ways of an arm through free space, and when it is where."""
