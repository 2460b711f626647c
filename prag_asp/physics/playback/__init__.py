"""Episodes as 3D scenes that play: their meshes, the motion of their bodies, and files for viewers."""
