"""What a plant is: declared signals and equations, Jacobians, equilibria, linear models, python-control."""
