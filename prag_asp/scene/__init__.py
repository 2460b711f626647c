"""The scene table of a domain: the shapes, looks and places of its entities, and their geometry."""
