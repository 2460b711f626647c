"""How bodies from files look: their visible surfaces with materials and textures."""
