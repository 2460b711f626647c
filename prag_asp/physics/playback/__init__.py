"""Episodes as 3D scenes that can be played: their meshes, the motion of their bodies, and files for viewers."""
