"""Control conventions: what the actions of robots mean, and how motor commands are converted to them and back."""
