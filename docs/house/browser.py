"""Is every page whole at every width? `python docs/house/browser.py [FOLDER or PAGE ...] [--pictures FOLDER]`.

Each page of build/site is opened in a headless Chromium at 360, 800 and 1,400 pixels, and in dark. Told are

wide     the page scrolls sideways, by what element
cut      text or a picture that reaches beyond an ancestor which hides what overflows
broken   a picture that did not load
faint    text whose contrast with what is behind it is below 3 to 1

Exit 1 if anything is. Where no browser is found nothing is checked: that is said, and the exit is 0. `--pictures`
keeps a picture of each page, width and colour scheme, for eyes.
"""

from __future__ import annotations

import argparse
import functools
import http.server
import itertools
import json
import queue
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar

ROOT = Path(__file__).parents[2]
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
WIDTHS = {"light": (360, 800, 1400), "dark": (800,)}  # [px]: where things stand is no matter of their colours
SCHEMES = {"light": 1, "dark": 0}  # Blink's numbers for prefers-color-scheme
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--force-device-scale-factor=1")
PATIENCE = 240  # [s] for one call of the browser, which looks at ..
AT_ONCE = 8  # .. so many pages
TALLEST = 12_000  # [px] of a picture: the browser paints no more at once

# Opens each page in a frame of each width, one after another, and sends back what it finds.
HARNESS = """<!doctype html><meta charset="utf-8"><body style="margin:0"><script>
const pages = PAGES, widths = WIDTHS, found = [];
const named = (e) => e.tagName.toLowerCase() + (e.id ? "#" + e.id : "") +
  (typeof e.className === "string" && e.className ? "." + e.className.trim().split(/\\s+/).join(".") : "") +
  " '" + (e.textContent || e.alt || "").trim().slice(0, 40).replace(/\\s+/g, " ") + "'";
const parts = (colour) => (colour.match(/[\\d.]+/g) || [0, 0, 0, 0]).map(Number);
const light = ([r, g, b]) => [r, g, b].map((c) => c / 255)
  .map((c) => c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
  .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
function behind(e, view) {  // the first opaque colour below an element
  for (; e; e = e.parentElement) {
    const colour = parts(view.getComputedStyle(e).backgroundColor);
    if (colour.length < 4 || colour[3] > 0.5) return colour;
  }
  return parts(view.matchMedia("(prefers-color-scheme: dark)").matches ? "rgb(18,18,18)" : "rgb(255,255,255)");
}
function look(doc, view, width) {
  const faults = [], root = doc.documentElement, seen = new Set();
  const tell = (kind, e, more) => {
    const line = kind + " " + named(e) + " " + more;
    if (!seen.has(line) && seen.size < 12) { seen.add(line); faults.push(line); }
  };
  const known = new Map([[doc.body, { scrolling: false, edge: Infinity, by: null }], [root, { edge: Infinity }]]);
  function held(e) {  // whether something about an element scrolls, and how far what clips it lets it reach
    if (known.has(e)) return known.get(e);
    const flow = view.getComputedStyle(e).overflowX, found = { ...held(e.parentElement) };
    if (flow === "auto" || flow === "scroll") Object.assign(found, { scrolling: true, edge: Infinity, by: null });
    const right = flow === "hidden" || flow === "clip" ? e.getBoundingClientRect().right : Infinity;
    if (right < found.edge) Object.assign(found, { edge: right, by: e });
    known.set(e, found);
    return found;
  }
  const scrolls = Math.max(root.scrollWidth, doc.body.scrollWidth) > width;
  for (const e of doc.body.querySelectorAll("*")) {
    const style = view.getComputedStyle(e), box = e.getBoundingClientRect();
    if (style.display === "none" || style.visibility === "hidden" || !box.width || !box.height) continue;
    if (e.matches("nav *") && /auto|scroll/.test(style.overflowX) && e.scrollWidth > e.clientWidth + 1)
      tell("cut", e, "of " + e.scrollWidth + " px " + e.clientWidth + " are seen");
    if (e.closest("[hidden], .md-sidebar, .md-search, .md-header, .md-tabs, dialog, svg *")) continue;
    if (e.tagName === "IMG" && e.complete && !e.naturalWidth) tell("broken", e, e.src);
    const own = [...e.childNodes].filter((n) => n.nodeType === 3 && n.textContent.trim());
    const { scrolling, edge, by } = held(e.parentElement);
    const flow = style.overflowX, clips = flow === "hidden" || flow === "clip";
    const inside = scrolling || flow === "auto" || flow === "scroll";
    let hidden = box.width > 1 && box.right > edge + 1 ? by : null;
    if (own.length && clips && e.scrollWidth > e.clientWidth + 1) hidden = e;
    if (!inside && scrolls && box.right > width + 1) tell("wide", e, Math.round(box.right) + " px");
    if (!inside && hidden && (own.length || /^(IMG|TABLE|PRE)$/.test(e.tagName)) && style.position !== "absolute")
      tell("cut", e, "by " + named(hidden).slice(0, 40));
    if (own.length && style.opacity > 0.9 && !e.closest("svg")) {
      const a = light(parts(style.color)), b = light(behind(e, view));
      const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      if (ratio < 3) tell("faint", e, ratio.toFixed(1) + ": " + style.color + " on " + behind(e, view));
    }
  }
  if (scrolls && !faults.length) faults.push("wide page scrolls to " + root.scrollWidth + " px");
  return faults;
}
async function all() {
  for (const page of pages) for (const width of widths) {
    const frame = document.createElement("iframe");
    frame.style = "border:0;height:900px;width:" + width + "px";
    await new Promise((done) => { frame.onload = done; frame.src = page; document.body.appendChild(frame); });
    await new Promise((done) => setTimeout(done, 60));
    const doc = frame.contentDocument;
    doc.querySelectorAll("details").forEach((d) => { d.open = true; });
    doc.querySelectorAll("img").forEach((i) => { i.loading = "eager"; });
    found.push({ page, width, height: doc.documentElement.scrollHeight,
      faults: look(doc, frame.contentWindow, width) });
    frame.remove();
  }
  await fetch("/-found", { method: "POST", body: JSON.stringify(found) });
}
all();
</script>"""
FRAME = """<!doctype html><meta charset="utf-8"><body style="margin:0">
<iframe style="border:0;display:block;width:{width}px;height:{height}px" src="{page}"></iframe>"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves a folder and the pages of the check, takes what the harness finds, and says nothing."""

    extra: ClassVar[dict[str, str]] = {}
    found: ClassVar[queue.Queue[str]] = queue.Queue()

    def do_GET(self) -> None:
        text = self.extra.get(self.path.split("?")[0])
        if text is None:
            return super().do_GET()
        self.answer(text.encode())

    def do_POST(self) -> None:
        self.found.put(self.rfile.read(int(self.headers["Content-Length"])).decode())
        self.answer(b"")

    def answer(self, body: bytes) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:
        pass


def browser() -> str | None:
    """The browser's path, None where there is none."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def pages_of(where: Path) -> tuple[Path, list[str]]:
    """The folder to serve and the pages in it, as addresses from its root."""
    if where.is_file():
        return where.parent, ["/" + where.name]
    found = sorted(where.rglob("*.html"))
    return where, ["/" + path.relative_to(where).as_posix() for path in found]


class Site:
    """A folder served to a browser of this machine alone while the check runs."""

    def __init__(self, folder: Path, program: str) -> None:
        self.program = program
        self.extra: dict[str, str] = {}
        self.found: queue.Queue[str] = queue.Queue()
        handler = type("Handler", (Quiet,), {"extra": self.extra, "found": self.found})
        self.server = http.server.ThreadingHTTPServer(
            ("127.0.0.1", 0), functools.partial(handler, directory=str(folder))
        )
        self.address = f"http://127.0.0.1:{self.server.server_port}"
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def __enter__(self) -> Site:
        return self

    def __exit__(self, *_: object) -> None:
        self.server.shutdown()
        self.server.server_close()

    def command(self, page: str, scheme: str, profile: str, *flags: str) -> list[str]:
        mode = f"--blink-settings=preferredColorScheme={SCHEMES[scheme]}"
        return [self.program, *FLAGS, mode, f"--user-data-dir={profile}", *flags, self.address + page]

    def looked(self, pages: Sequence[str], scheme: str) -> list[dict[str, object]]:
        """What the harness finds of pages: [{page, width, height, faults}]."""
        text = HARNESS.replace("PAGES", json.dumps(list(pages)), 1).replace("WIDTHS", json.dumps(WIDTHS[scheme]), 1)
        self.extra["/-harness.html"] = text
        flags = ("--remote-debugging-port=0", "--window-size=1500,1000")  # with the first it stays until it is ended
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
            command = self.command("/-harness.html", scheme, profile, *flags)
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
                try:
                    return json.loads(self.found.get(timeout=PATIENCE))
                except queue.Empty:
                    raise TimeoutError(f"the browser did not get through {', '.join(pages)}") from None
                finally:
                    process.terminate()

    def picture(self, page: str, width: int, height: int, scheme: str, path: Path) -> None:
        """One page as it is painted at one width, down to TALLEST."""
        height = min(height, TALLEST)
        self.extra["/-frame.html"] = FRAME.format(width=width, height=height, page=page)
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
            flags = (f"--window-size={width},{height}", f"--screenshot={path}")
            command = self.command("/-frame.html", scheme, profile, *flags)
            subprocess.run(command, capture_output=True, timeout=PATIENCE, check=True)


def faults(where: Path, program: str, pictures: Path | None = None) -> Iterator[str]:
    """Every fault of the pages at `where`, one a line."""
    folder, pages = pages_of(where)
    if not pages:
        yield f"{where}: no page; `make docs` makes them"
    with Site(folder, program) as site:
        for scheme in SCHEMES:
            looked = (site.looked(pages[k : k + AT_ONCE], scheme) for k in range(0, len(pages), AT_ONCE))
            for told in itertools.chain.from_iterable(looked):
                page, width, height = str(told["page"]), int(str(told["width"])), int(str(told["height"]))
                for fault in told["faults"] if isinstance(told["faults"], list) else ():
                    yield f"{page} at {width} px, {scheme}: {fault}"
                if pictures is not None:
                    name = page.strip("/").replace("/", "-").removesuffix(".html")
                    site.picture(page, width, height, scheme, pictures / f"{name}-{width}-{scheme}.png")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("where", nargs="*", type=Path, default=[ROOT / "build" / "site"], help="folders or pages")
    parser.add_argument("--pictures", type=Path, help="keep a picture of each page, width and scheme here")
    given = parser.parse_args()
    program = browser()
    if program is None:
        print(f"no browser ({', '.join(BROWSERS)}): the pages' widths are not checked", file=sys.stderr)
        return 0
    found = [fault for where in given.where for fault in faults(where.resolve(), program, given.pictures)]
    print(*found, sep="\n", end="\n" if found else "")
    print(f"{len(found)} faults" if found else "nothing is cut off", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
