"""What a plant says of itself, held against its own equations: `pliant.plants.check(plant)`."""
