"""The range in which each kinematics holds, derived, and what a motion leaves of it."""
