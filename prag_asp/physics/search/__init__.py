"""The search for a witness: first states, actions, and room for what comes."""
