"""Laws for what is known to be unknown: one gain for every model of a box, with and without delay."""
