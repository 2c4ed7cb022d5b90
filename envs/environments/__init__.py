"""A scene as a Gymnasium environment, as a vector environment, and for Stable-Baselines3."""
