"""Derivatives of linear predictive control through its quadratic program, and weights tuned by them."""
