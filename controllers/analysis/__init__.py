"""Linear loops, their margins, spillover on finer plants."""
