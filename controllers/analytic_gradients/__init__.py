"""Policies by exact gradients: the cost of episodes, differentiated through the plant's native step (NumPy alone)."""
