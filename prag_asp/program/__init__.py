"""The author's logic text: its files, their syntax, the facts that they state."""
