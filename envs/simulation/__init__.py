"""One control period on many lanes: the symbolic step, its kernel, the start of an episode."""
