"""What every controller stands on: act(t, y) -> u, what it may ask of a scene, costs by name, models about a goal."""
