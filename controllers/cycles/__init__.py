"""Laws of a machine that runs in a cycle."""
