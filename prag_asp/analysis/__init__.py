"""What spaces of tasks look like: figures and pictures."""
