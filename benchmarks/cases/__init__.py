"""What is measured of Pliant, a module a part of the run."""
