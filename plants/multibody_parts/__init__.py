"""What a tree of bodies is made of: joints, bodies, beams that move in space, steps between frames, URDF files."""
