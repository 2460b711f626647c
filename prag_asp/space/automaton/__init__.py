"""The automaton of a space: explored, merged, determinised, counted on."""
