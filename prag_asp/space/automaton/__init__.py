"""The automaton of a space: exploration, state merging, determinisation and counting."""
