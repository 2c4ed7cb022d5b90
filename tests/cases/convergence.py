"""How fast an error falls."""

import numpy as np


def slope(x, y):
    """Exponent of y ~ x^slope by least squares."""
    return np.polyfit(np.log(x), np.log(y), 1)[0]
