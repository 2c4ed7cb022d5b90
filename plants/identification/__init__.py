"""Parameters of a plant from measured motions, how sure they are, and which motion tells most."""
