"""The scene table of a domain: the shapes, appearance and places of its entities, and their geometry."""
