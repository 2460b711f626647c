"""The search for a witness: initial states, actions, and leaving room for later actions."""
