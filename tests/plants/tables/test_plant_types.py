from dataclasses import dataclass

import pytest

from pliant.plants import SingleLinkArm
from pliant.plants.tables import plant_types
from pliant.plants.tables.plant_tables import from_table


def test_a_registered_type_is_known_by_its_name(monkeypatch):
    monkeypatch.setattr(plant_types, "_registered", {})

    @plant_types.register
    @dataclass(frozen=True, kw_only=True)
    class ShortArm(SingleLinkArm):
        pass

    assert "ShortArm" in plant_types.names()
    assert type(from_table({"type": "ShortArm", "make": "textbook"})) is ShortArm


@pytest.mark.parametrize("kind", [int, 3, SingleLinkArm, SingleLinkArm.textbook()])
def test_what_is_no_plant_of_ones_own_is_refused(kind):
    with pytest.raises(ValueError, match=r"register: kind = .* must"):
        plant_types.register(kind)
