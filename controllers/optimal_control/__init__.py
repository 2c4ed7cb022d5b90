"""Optimal control by multiple shooting, planning, nominal motions."""
