"""Sections that turn as far as they like: quadrature along their tangents, energies of one link."""
