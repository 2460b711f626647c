"""The appearance of bodies loaded from files: their visible surfaces with materials and textures."""
