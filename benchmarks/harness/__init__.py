"""How the rows are sampled, tabled and judged."""
