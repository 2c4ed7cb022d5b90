"""Which values of one function can be computed together, as the elements of a vector.

Sums of products that differ only in their constants, or in which element of earlier vectors they take, are one vector
operation: products with a constant matrix, Gram matrices, products element by element. So are calls of sin, cos, exp,
tanh, sqrt and reciprocals. Values of one depth do not need each other: vectors are made depth by depth.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import casadi as ca

from .expression_graph import Graph, Term

FEWEST = 2  # elements of a vector
CALLS = (ca.OP_SIN, ca.OP_COS, ca.OP_EXP, ca.OP_TANH, ca.OP_SQRT, ca.OP_INV)
ALONE = 2  # see `Packing._template`
CONSTANT = -1  # in place of a node: a constant, which may differ from element to element

Product = tuple[int, int, int]  # a term with CONSTANT in place of constants, the sign then being 1
Sum = list[tuple[Product, float]]  # with the constants, signs included
Operand = tuple[str, int]  # ("all", node) one for all elements, ("each", vector) its element in the same place
Shapes = tuple[tuple[int, Operand, Operand], ...]  # of the terms of a sum: sign, factors


@dataclass
class Vector:
    """Nodes that are computed together: elements[l] is element l. A sum of shapes, or op called on the arguments."""

    elements: dict[int, int]
    shapes: Shapes = ()
    tables: dict[int, list[float]] = field(default_factory=dict)  # number of a term -> constant of each element
    op: int | None = None
    source: int | None = None  # the vector of a call's arguments; None: gathered one by one


class Packing:
    """order: of every depth the scalars that are left and the numbers of the vectors; vectors: all of them."""

    def __init__(self, graph: Graph, width: int) -> None:
        self.graph, self.width = graph, width
        self.vectors: list[Vector] = []
        self._shared: set[Product] = set()  # what several sums of the depth at hand have
        self.order: list[tuple[list[int], range]] = []
        levels: dict[int, list[int]] = defaultdict(list)
        for i in graph.kept:
            if not graph.nodes[i].given:
                levels[graph.nodes[i].depth].append(i)
        for depth in sorted(levels):
            first = len(self.vectors)
            self._calls([i for i in levels[depth] if graph.nodes[i].op in CALLS])
            self._sums([i for i in levels[depth] if graph.nodes[i].terms])
            self.order.append(([i for i in levels[depth] if self._free(i)], range(first, len(self.vectors))))

    def gain(self, registers: int) -> float:
        """Scalar operations in place of one, where a vector takes so many registers of the machine."""

        def cost(nodes: Iterable[int]) -> int:
            return sum(max(1, len(self.graph.nodes[i].terms)) for i in nodes)

        before = cost(i for i in self.graph.kept if not self.graph.nodes[i].given)
        after = sum(cost(scalars) for scalars, _ in self.order)
        return before / max(1, after + registers * sum(max(1, len(v.shapes)) for v in self.vectors))

    def _free(self, i: int) -> bool:
        return self.graph.nodes[i].place is None

    def _place(self, vector: Vector) -> None:
        for l, i in vector.elements.items():
            self.graph.nodes[i].place = (len(self.vectors), l)
        self.vectors.append(vector)

    def _calls(self, level: list[int]) -> None:
        nodes = self.graph.nodes
        groups: dict[tuple[int, int], dict[int, int]] = defaultdict(dict)
        loose: dict[int, list[int]] = defaultdict(list)
        for i in level:
            place = nodes[nodes[i].args[0]].place
            if place is None:
                loose[nodes[i].op].append(i)
            else:
                groups[nodes[i].op, place[0]][place[1]] = i
        for (op, source), elements in groups.items():
            if len(elements) < FEWEST:
                loose[op] += elements.values()
            else:
                self._place(Vector(elements, op=op, source=source))
        for op, several in loose.items():
            for k in range(0, len(several), self.width):
                if len(part := several[k : k + self.width]) >= FEWEST:
                    self._place(Vector(dict(enumerate(part)), op=op))

    def _factors(self, term: Term) -> tuple[Product, float]:
        number, factors = float(term[0]), []
        for i in term[1:]:
            constant = self.graph.nodes[i].constant
            number *= 1.0 if constant is None else constant
            factors.append(i if constant is None else CONSTANT)
        return (term[0] if CONSTANT not in factors else 1, min(factors), max(factors)), number

    def _template(self, products: Iterable[Product], element: int, one_each: int) -> Shapes:
        """How a sum looks if it becomes this element of a vector: which of its factors stand there in theirs.

        Of two factors that both do, one_each = 1 or -1 takes the one of the earlier or later vector only. What stands
        in several sums may stand in its place by chance: one_each = ALONE takes no such term's factors.
        """
        shapes = []
        for sign, *factors in products:
            places = [self.graph.nodes[i].place if i != CONSTANT else None for i in factors]
            operands: list[Operand] = [
                ("each", place[0])
                if place and place[1] == element and not (one_each == ALONE and (sign, *factors) in self._shared)
                else ("all", i)
                for place, i in zip(places, factors)
            ]
            if one_each in (1, -1) and operands[0][0] == operands[1][0] == "each":
                later = int(operands[0][1] <= operands[1][1])
                dropped = later if one_each > 0 else 1 - later
                operands[dropped] = ("all", factors[dropped])
            shapes.append((sign, operands[0], operands[1]))
        return tuple(sorted(shapes))

    def _products(self, shapes: Shapes, element: int) -> list[Product]:
        """The terms that a sum must have to be this element of a vector; none where there can be no such sum."""
        found = []
        for sign, *operands in shapes:
            factors = [i if kind == "all" else self.vectors[i].elements.get(element) for kind, i in operands]
            known = [i for i in factors if i is not None]
            if len(known) < 2:
                return []
            found.append((sign, min(known), max(known)))
        return found

    def _sums(self, level: list[int]) -> None:
        nodes = self.graph.nodes
        sums = {i: [self._factors(term) for term in nodes[i].terms] for i in level}
        alike: dict[tuple[Product, ...], list[int]] = defaultdict(list)
        for i, terms in sums.items():
            alike[tuple(sorted(product for product, _ in terms))].append(i)
        times = Counter(product for products in alike for product in set(products))
        self._shared = {product for product, several in times.items() if several > 1}
        choices: dict[Shapes, list[list[int]]] = {}  # nodes that could be each element
        for products, several in alike.items():
            if len(several) >= FEWEST:  # they differ in constants alone
                choices[_for_all(products)] = [several] * self.width
            factors = {i for _, *pair in products for i in pair if i != CONSTANT}
            for element in {place[1] for i in factors if (place := nodes[i].place)}:
                for one_each in (0, 1, -1, ALONE):
                    shapes = self._template(products, element, one_each)
                    if shapes not in choices:
                        wanted = (self._products(shapes, l) for l in range(self.width))
                        choices[shapes] = [alike.get(tuple(sorted(w)), []) for w in wanted]
        self._choose(choices, sums)
        self._nested({i: terms for i, terms in sums.items() if self._free(i)})

    def _choose(self, choices: dict[Shapes, list[list[int]]], sums: dict[int, Sum]) -> None:
        """Make vectors of the choices, those of most elements first, of these the ones of most factors for all."""
        spread = {shapes: sum(kind == "all" for _, *pair in shapes for kind, _ in pair) for shapes in choices}
        most = {shapes: len(self._pick(candidates)) for shapes, candidates in choices.items()}
        while most:
            shapes = max(most, key=lambda s: (most[s], spread[s]))
            picked = self._pick(choices[shapes])
            if len(picked) < FEWEST:
                del most[shapes]
            elif len(picked) < most[shapes]:
                most[shapes] = len(picked)
            else:
                self._sum(shapes, picked, sums)

    def _pick(self, candidates: Sequence[list[int]]) -> dict[int, int]:
        """A free node for every element that has one."""
        picked: dict[int, int] = {}
        for l, several in enumerate(candidates):
            free = next((i for i in several if self._free(i) and i not in picked.values()), None)
            if free is not None:
                picked[l] = free
        return picked

    def _sum(self, shapes: Shapes, elements: dict[int, int], sums: dict[int, Sum]) -> None:
        vector = Vector(elements, shapes)
        for l, i in elements.items():
            numbers: dict[Product, list[float]] = defaultdict(list)
            for product, number in sums[i]:
                numbers[product].append(number)
            for k, product in enumerate(self._products(shapes, l)):
                if product[1] == CONSTANT:
                    row = vector.tables.setdefault(k, [0.0] * self.width)
                    row[l] = numbers[product].pop() if numbers[product] else 0.0
        self._place(vector)

    def _nested(self, sums: dict[int, Sum]) -> None:
        """Sums with constants over parts of one set of nodes, such as a triangular matrix times a vector."""
        sets = {i: {product for product, _ in terms} for i, terms in sums.items()}
        left = [i for i, own in sets.items() if len(own) == len(sums[i]) and all(p[1] == CONSTANT for p in own)]
        left.sort(key=lambda i: -len(sets[i]))
        while left:
            whole = sets[left[0]]
            part = [i for i in left if sets[i] <= whole][: self.width]
            left = [i for i in left if i not in part]
            if len(part) >= FEWEST and sum(len(sets[i]) for i in part) >= FEWEST * len(whole):
                self._sum(_for_all(sorted(whole)), dict(enumerate(part)), sums)


def _for_all(products: Iterable[Product]) -> Shapes:
    """The same factors for all elements."""
    return tuple((sign, ("all", a), ("all", b)) for sign, a, b in products)
