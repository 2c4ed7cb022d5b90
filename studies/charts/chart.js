(function () {
  for (const box of document.querySelectorAll(".chart")) {
    const points = JSON.parse(box.querySelector("script").textContent);
    const tip = box.querySelector(".tip"), picture = box.querySelector("svg");
    const marks = Object.keys(points).map((id) => ({ id: id, told: points[id], element: picture.getElementById(id) }))
      .filter((mark) => mark.element);
    let shown = null;

    function place(mark) {
      const own = mark.element.getBoundingClientRect();
      return [own.left + own.width / 2, own.top + own.height / 2];
    }
    function show(mark) {
      if (mark === shown) return;
      shown = mark;
      for (const other of marks) {
        const apart = mark && mark.told.variant && other.told.variant !== mark.told.variant;
        other.element.style.opacity = apart ? 0.12 : "";
      }
      tip.hidden = !mark;
      if (!mark) return;
      tip.replaceChildren(...mark.told.lines.map((line, i) => {
        const part = document.createElement(i ? "div" : "strong");
        part.textContent = line;
        return part;
      }));
      const frame = box.getBoundingClientRect(), at = place(mark);
      const left = Math.min(at[0] - frame.left + 14, frame.width - tip.offsetWidth - 4);
      const above = at[1] - frame.top - tip.offsetHeight - 12;
      tip.style.left = Math.max(0, left) + "px";
      tip.style.top = (above < 0 ? at[1] - frame.top + 14 : above) + "px";
    }
    for (const mark of marks) {
      mark.element.setAttribute("tabindex", "0");
      mark.element.setAttribute("role", "img");
      mark.element.setAttribute("aria-label", mark.told.lines.join(", "));
      mark.element.addEventListener("focus", () => show(mark));
      mark.element.addEventListener("blur", () => show(null));
    }
    picture.addEventListener("pointermove", (event) => {
      let nearest = null, least = 16;
      for (const mark of marks) {
        const at = place(mark), far = Math.hypot(at[0] - event.clientX, at[1] - event.clientY);
        if (far < least) [nearest, least] = [mark, far];
      }
      show(nearest);
    });
    picture.addEventListener("pointerleave", () => show(null));
  }
})();
