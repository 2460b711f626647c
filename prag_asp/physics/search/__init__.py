"""The search for a witness: initial states, actions, and room for later actions."""
