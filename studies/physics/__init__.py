"""What physics gives on a scene's motion, found from a simple one, and what each of its effects is worth there."""
