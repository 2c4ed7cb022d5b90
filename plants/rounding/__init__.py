"""What a CasADi function's value is, how far rounding moves it, and whether compiled code stays within that."""
