"""Numerical programs: quadratic (DAQP), interior point, block sparsity, H-infinity norm."""
