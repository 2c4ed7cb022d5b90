"""LQR, LQG, TVLQR with its funnel, compensation of delay."""
