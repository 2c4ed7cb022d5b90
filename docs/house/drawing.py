"""Draw the rooms and who imports whom: `make architecture` writes docs/architecture.svg. No other program is needed.

Rooms stand in layers, each above what it imports; an arrow points from the importing room to the imported one. Arrows
that follow from others (a imports b, b imports c, so a -> c) are left out. Layout after Sugiyama: layers by longest
path, order within a layer by barycentres, arrows that cross layers led through gaps between the boxes.
"""

from __future__ import annotations

import sys
import textwrap
from dataclasses import dataclass, field
from html import escape
from itertools import pairwise
from pathlib import Path

from import_graph import ROOT, between_rooms, imports, modules, room_of, settings

from pliant.plants.files.atomic_files import write_text

OUT = ROOT / "docs" / "architecture.svg"
BOX, HEIGHT, GAP, THREAD = 178, 74, 22, 16  # [px] a room, the space beside it, the width left to an arrow
ROW = HEIGHT + 58  # [px] from layer to layer
MARGIN, HEAD = 34, 96
BETWEEN = 64  # [px] more, between the bands of two folders
COLOUR = {"plants": "#1b6e53", "controllers": "#2c5f9e", "envs": "#8a5a13", "studies": "#7d3c78"}
SAYS = {
    "plants": "models and their linear descriptions; knows nothing of the rest",
    "controllers": "everything with act(t, y) -> u",
    "envs": "scenes wrapped for learning",
    "studies": "what people run",
}
GROUP = {"controllers": 0, "": 1, "envs": 2, "plants": 1, "studies": 1}  # left, middle, right
Edge = tuple[str, str]


@dataclass
class Node:
    """A room, or a point where an arrow passes a layer (room empty)."""

    name: str
    layer: int
    room: str = ""
    x: float = 0.0
    up: list[str] = field(default_factory=list)
    down: list[str] = field(default_factory=list)

    @property
    def width(self) -> int:
        return BOX + GAP if self.room else THREAD


def reduced(edges: set[Edge]) -> set[Edge]:
    """Without the edges that follow from a longer way (transitive reduction; edges without circles)."""
    below: dict[str, set[str]] = {}
    for source, target in edges:
        below.setdefault(source, set()).add(target)

    def reach(start: str, seen: set[str]) -> set[str]:
        for node in below.get(start, ()):
            if node not in seen:
                seen.add(node)
                reach(node, seen)
        return seen

    return {(s, t) for s, t in edges if not any(t in reach(other, set()) for other in below[s] - {t})}


def layers(rooms: list[str], edges: set[Edge]) -> dict[str, int]:
    """{room: layer}, 0 at the bottom: one above the highest that it imports in its folder; folders in bands."""
    place: dict[str, int] = {}
    start = 0
    for band in (("plants",), ("controllers", "envs"), ("studies",)):
        inside = [room for room in rooms if room.split(".")[0] in band]
        for room in inside:  # in the order of rooms.toml, so that what it imports stands already
            lower = [place[t] + 1 for s, t in edges if s == room and t in inside and t in place]
            place[room] = max(lower, default=start)
        start = max((place[room] for room in inside), default=start) + 1
    return place


def network(rooms: list[str], edges: set[Edge]) -> dict[str, Node]:
    """Rooms and passing points by name, joined from layer to layer."""
    place = layers(rooms, edges)
    nodes = {room: Node(room, place[room], room) for room in rooms}
    for source, target in sorted(edges):
        upper = source
        for layer in range(place[source] - 1, place[target], -1):
            name = f"{source}>{target}@{layer}"
            nodes[name] = Node(name, layer)
            nodes[upper].down.append(name)
            nodes[name].up.append(upper)
            upper = name
        nodes[upper].down.append(target)
        nodes[target].up.append(upper)
    return nodes


def arranged(nodes: dict[str, Node], sweeps: int = 600) -> list[list[Node]]:
    """Layers from the bottom, each from left to right, with x set: neighbours near each other, boxes apart."""
    rows: list[list[Node]] = [[] for _ in range(max(n.layer for n in nodes.values()) + 1)]
    for node in nodes.values():
        rows[node.layer].append(node)
    sides = [{"controllers", "envs"} & {n.room.split(".")[0] for n in row} for row in rows]

    def group(node: Node) -> int:
        return GROUP[node.room.split(".")[0]] if sides[node.layer] else 1

    for row in rows:
        row.sort(key=group)
        _pack(row, [float(k) * BOX for k in range(len(row))])
    for sweep in range(sweeps):
        for row in rows if sweep % 2 else rows[::-1]:
            ends = [(n.down if sweep % 2 else n.up) or n.down + n.up for n in row]
            settle = sweep >= 60  # the order stays; places follow all neighbours until the ways are straight
            if settle:
                ends = [n.down + n.up for n in row]
            wish = [sum(nodes[e].x for e in end) / len(end) if end else n.x for n, end in zip(row, ends)]
            order = list(range(len(row)))
            if not settle:
                order.sort(key=lambda k: (group(row[k]), wish[k]))
            row[:] = [row[k] for k in order]
            _pack(row, [wish[k] for k in order])
    return rows


def _pack(row: list[Node], wish: list[float]) -> None:
    """Set x near the wishes, in order and apart: neighbours that collide are merged and stand about their mean."""
    blocks: list[list] = []  # [sum of (wish - offset), count, width, nodes with offsets]
    for node, x in zip(row, wish):
        block = [x, 1, node.width, [(node, 0.0)]]
        while blocks:
            last = blocks[-1]
            shift = last[2] - last[3][0][0].width / 2 + block[3][0][0].width / 2
            if last[0] / last[1] + shift <= block[0] / block[1]:
                break
            members = last[3] + [(n, offset + shift) for n, offset in block[3]]
            block = [last[0] + block[0] - shift * block[1], last[1] + block[1], last[2] + block[2], members]
            blocks.pop()
        blocks.append(block)
    for total, count, _, members in blocks:
        for node, offset in members:
            node.x = total / count + offset


def svg() -> str:
    """The drawing of the tree as it is."""
    found = modules()
    rooms = [room["name"] for room in settings()["room"]]
    says = {room["name"]: room["what"] for room in settings()["room"]}
    order = {room: k for k, room in enumerate(rooms)}
    counts = between_rooms(imports(found))
    edges = {(s, t) for s, t in counts if order[t] < order[s]}
    shown = reduced(edges)
    nodes = network(rooms, shown)
    rows = arranged(nodes)
    left = min(n.x - n.width / 2 for n in nodes.values())
    width = max(n.x + n.width / 2 for n in nodes.values()) - left + 2 * MARGIN
    band = {room: 0 if room.startswith("plants") else 2 if room.startswith("studies") else 1 for room in rooms}
    first = {b: min(nodes[r].layer for r in rooms if band[r] == b) for b in range(3)}
    height = HEAD + len(rows) * ROW + 2 * BETWEEN + 24

    def top(layer: int) -> float:
        above = sum(layer >= first[b] for b in range(3))
        return height - 36 - (layer + 1) * ROW - (above - 1) * BETWEEN + (ROW - HEIGHT)

    for node in nodes.values():
        node.x += MARGIN - left
    lines = {m: path.read_text("utf-8").count("\n") for m, path in found.items()}
    parts = [_panel(folder, [nodes[r] for r in rooms if r.startswith(folder + ".")], top) for folder in COLOUR]
    parts += [_arrow(edge, nodes, top) for edge in sorted(shown)]
    for room in rooms:
        inside = [m for m in found if room_of(m) == room]
        imported = ", ".join(t for s, t in sorted(edges) if s == room) or "nothing of Pliant"
        size = f"{len(inside)} files, {sum(lines[m] for m in inside):,} lines"
        parts.append(_box(nodes[room], top(nodes[room].layer), says[room], size, f"{room} imports {imported}"))
    total = f"{len(found)} files, {sum(lines.values()):,} lines, {len(rooms)} rooms; {len(edges)} arrows between rooms"
    head = (
        f'<text x="{MARGIN}" y="40" class="title">Pliant, room by room</text>'
        f'<text x="{MARGIN}" y="66" class="what">An arrow points from a room to one that it imports; arrows that '
        f"follow from others are left out. {total}, {len(shown)} drawn.</text>"
    )
    style = (
        "text{font-family:'Inter','Segoe UI','Helvetica Neue',Arial,sans-serif;fill:#1d2733}.title{font-size:26px;"
        "font-weight:700}.name{font-size:14px;font-weight:650}.what{font-size:10.5px;fill:#45525f}.size{font-size:9.5px;"
        "fill:#7a8794}.folder{font-size:19px;font-weight:700}.arrow{fill:none;stroke-width:1.15;stroke-opacity:.62}"
        "g.room:hover rect{stroke-width:2.6}"
    )
    heads = "".join(
        f'<marker id="{name}" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        f'<path d="M0,1 L7,4 L0,7 z" fill="{colour}" fill-opacity=".8"/></marker>'
        for name, colour in COLOUR.items()
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" '
        f'height="{height:.0f}" role="img" aria-label="The rooms of Pliant and their imports"><style>{style}</style>'
        f'<defs>{heads}</defs><rect width="100%" height="100%" fill="#fff"/>{head}\n' + "\n".join(parts) + "\n</svg>\n"
    )


def _panel(folder: str, nodes: list[Node], top) -> str:
    """The ground on which a folder's rooms stand, with its name."""
    x0 = min(n.x for n in nodes) - BOX / 2 - 14
    x1 = max(n.x for n in nodes) + BOX / 2 + 14
    y0 = min(top(n.layer) for n in nodes) - 44
    y1 = max(top(n.layer) for n in nodes) + HEIGHT + 14
    colour = COLOUR[folder]
    name = f'<tspan class="folder" style="fill:{colour}">{folder}/</tspan>'
    text = f'{name}<tspan dx="9" class="what">{escape(SAYS[folder])}</tspan>'
    return (
        f'<rect x="{x0:.1f}" y="{y0:.1f}" width="{x1 - x0:.1f}" height="{y1 - y0:.1f}" rx="14" fill="{colour}" '
        f'fill-opacity=".07"/><text x="{x0 + 14:.1f}" y="{y0 + 26:.1f}">{text}</text>'
    )


def _box(node: Node, y: float, what: str, size: str, title: str) -> str:
    folder, name = node.room.split(".")
    x = node.x - BOX / 2
    words = textwrap.wrap(what, 31)[:3]
    if len(textwrap.wrap(what, 31)) > 3:
        words[-1] += " ..."
    said = "".join(
        f'<text x="{x + 10:.1f}" y="{y + 31 + 12 * k:.1f}" class="what">{escape(w)}</text>' for k, w in enumerate(words)
    )
    return (
        f'<g class="room"><title>{escape(title)}</title><rect x="{x:.1f}" y="{y:.1f}" width="{BOX}" height="{HEIGHT}" '
        f'rx="8" fill="#fff" stroke="{COLOUR[folder]}" stroke-width="1.4"/><text x="{x + 10:.1f}" y="{y + 17:.1f}" '
        f'class="name">{name}</text>{said}<text x="{x + 10:.1f}" y="{y + HEIGHT - 6:.1f}" class="size">{size}'
        "</text></g>"
    )


def _port(node: Node, other: str, nodes: dict[str, Node], upward: bool) -> float:
    """Where an arrow leaves or meets a node: spread along a box's side in the order of where the arrows come from."""
    if not node.room:
        return node.x
    ends = sorted(node.up if upward else node.down, key=lambda e: nodes[e].x)
    step = min(26.0, (BOX - 30) / max(1, len(ends) - 1)) if len(ends) > 1 else 0.0
    return node.x + (ends.index(other) - (len(ends) - 1) / 2) * step


def _arrow(edge: Edge, nodes: dict[str, Node], top) -> str:
    source, target = edge
    passing = [f"{source}>{target}@{k}" for k in range(nodes[source].layer - 1, nodes[target].layer, -1)]
    way = [source, *passing, target]
    path = ""
    for upper, lower in pairwise(way):
        x0, y0 = _port(nodes[upper], lower, nodes, False), top(nodes[upper].layer) + HEIGHT
        x1, y1 = _port(nodes[lower], upper, nodes, True), top(nodes[lower].layer) - (2 if lower == target else 0)
        bend = 0.5 * (y1 - y0)
        path += f"{'M' if not path else 'L'}{x0:.1f},{y0:.1f} C{x0:.1f},{y0 + bend:.1f} "
        path += f"{x1:.1f},{y1 - bend:.1f} {x1:.1f},{y1:.1f} "
    folder = source.split(".")[0]
    return (
        f'<path class="arrow" d="{path.strip()}" stroke="{COLOUR[folder]}" marker-end="url(#{folder})">'
        f"<title>{source} imports {target}</title></path>"
    )


def main(out: Path = OUT) -> None:
    write_text(out, svg())
    print(out, file=sys.stderr)


if __name__ == "__main__":
    main()
