"""What stands between the nodes of a motion or of a linear model along it."""
