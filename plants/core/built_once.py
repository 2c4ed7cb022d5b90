"""Properties that are built once for all equal plants: a plant made anew from the same numbers finds them there."""

from __future__ import annotations

from collections import OrderedDict
from functools import cached_property
from typing import Any, ClassVar, TypeVar

T = TypeVar("T")
KEPT = 32  # plants whose properties are kept


class built_once(cached_property[T]):
    """A cached property whose value depends on the fields of a frozen dataclass alone.

    Where an equal instance has had it built, it is taken from there, of the last KEPT different instances. A symbolic
    copy (`nominal` differs from it) builds its own: expressions have no equality.
    """

    _kept: ClassVar[OrderedDict[Any, dict[str, Any]]] = OrderedDict()

    def __get__(self, instance: Any, owner: type | None = None) -> Any:
        if instance is None or instance.nominal is not instance:
            return super().__get__(instance, owner)
        name = str(self.attrname)
        shared = instance.__dict__.get("_shared")
        if shared is None:  # for good: all that an instance takes must be in the same symbols
            shared = instance.__dict__["_shared"] = self._of_equals(instance)
        if name not in shared:
            shared[name] = super().__get__(instance, owner)
        instance.__dict__[name] = shared[name]
        return shared[name]

    @classmethod
    def _of_equals(cls, instance: Any) -> dict[str, Any]:
        try:
            found = cls._kept.setdefault(instance, {})
            cls._kept.move_to_end(instance)
            if len(cls._kept) > KEPT:
                cls._kept.popitem(last=False)
        except (TypeError, KeyError):  # a plant with a field that has no hash, or two threads at once
            return {}
        return found
