"""What CasADi functions give at many rows, without compiling them."""
