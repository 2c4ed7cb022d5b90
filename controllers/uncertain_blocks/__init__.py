"""Structured singular values of a linear system with uncertain blocks: lower and upper bounds, at all frequencies."""
