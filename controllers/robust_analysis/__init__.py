"""Boxes of parameters and uncertain blocks: structured singular values, robust gains of motions that end."""
