"""Linearly implicit methods: their coefficients, one adaptive motion with dense output, the same in native code."""
