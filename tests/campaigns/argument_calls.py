"""All calls of the campaign of bad input, room by room."""

from argument_kinds import Call
from calls_of_identification import identification_calls
from calls_of_laws import law_calls
from calls_of_models import model_calls
from calls_of_plants import plant_calls


def calls() -> list[Call]:
    """A valid call of every public callable."""
    return [*plant_calls(), *identification_calls(), *model_calls(), *law_calls()]
