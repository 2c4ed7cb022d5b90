"""What a loop or a motion stands over a box of a plant's parameters, and robust gains of motions that end."""
