"""The vocabulary: errors, named signals, parameters with units, trajectories, rotations, Runge-Kutta tableaux."""
