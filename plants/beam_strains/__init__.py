"""Beams by all their strains: free and moving roots, extension, shear, curved rest shapes, any load at the tip."""
