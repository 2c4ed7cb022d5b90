"""What a plant is: declared signals and equations, Jacobians, equilibria, step sensitivities, python-control."""
