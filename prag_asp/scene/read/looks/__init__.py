"""The appearance of bodies from files: their visible surfaces with materials and textures."""
