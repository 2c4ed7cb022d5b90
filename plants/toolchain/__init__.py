"""Other programs that Pliant runs: what is said of them in the environment, and how they are ended."""
