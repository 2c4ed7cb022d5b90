"""An outside task with published results: the two carts of the American Control Conference, 1990."""

from .comparison import Row, compared
from .machine import SCENE, two_carts
from .merit import Merit, merit, score
from .published import PUBLISHED, Published

__all__ = ["PUBLISHED", "SCENE", "Merit", "Published", "Row", "compared", "merit", "score", "two_carts"]
