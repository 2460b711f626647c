"""Processes beside this one: how they are started, what they may take, and what this one is just doing."""
