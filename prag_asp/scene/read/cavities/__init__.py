"""Find the cavities of bodies, by flooding a grid and between vertical walls."""
