(function () {
  const box = document.getElementById("arm");
  if (!box) return;
  const data = JSON.parse(box.querySelector("script").textContent);
  const picture = box.querySelector("svg"), slider = box.querySelector("input");
  const shown = box.querySelector("output"), button = box.querySelector("button"), key = box.querySelector(".key");
  const colours = ["var(--accent)", "var(--second)"];
  const space = picture.namespaceURI;
  const all = data.arms.flatMap((arm) => arm.lines.flat());
  const xs = all.map((p) => p[0]), ys = all.map((p) => -p[1]);
  const low = [Math.min(...xs), Math.min(...ys)], high = [Math.max(...xs), Math.max(...ys)];
  const size = Math.max(high[0] - low[0], high[1] - low[1]), edge = 0.06 * size;
  picture.setAttribute("viewBox", [low[0] - edge, low[1] - edge, high[0] - low[0] + 2 * edge,
    high[1] - low[1] + 2 * edge].join(" "));

  function draw(kind, attributes) {
    const element = document.createElementNS(space, kind);
    for (const name in attributes) element.setAttribute(name, attributes[name]);
    picture.appendChild(element);
    return element;
  }
  const points = (line) => line.map((p) => p[0] + "," + -p[1]).join(" ");
  const parts = data.arms.map((arm, i) => {
    const paint = { fill: "none", stroke: colours[i], "stroke-linecap": "round", "stroke-linejoin": "round" };
    const label = document.createElement("span");
    label.textContent = arm.name;
    label.style.borderColor = colours[i];
    key.appendChild(label);
    return {
      arm: arm,
      path: draw("polyline", { ...paint, "stroke-width": 0.004 * size, opacity: 0.5 }),
      line: draw("polyline", { ...paint, "stroke-width": 0.012 * size }),
      tip: draw("circle", { r: 0.018 * size, fill: colours[i] }),
      root: draw("circle", { r: 0.015 * size, fill: "currentColor" }),
    };
  });

  function show() {
    const k = Number(slider.value);
    shown.textContent = data.t[k].toFixed(2) + " s";
    for (const part of parts) {
      const line = part.arm.lines[k], tip = line[line.length - 1];
      part.line.setAttribute("points", points(line));
      part.path.setAttribute("points", points(part.arm.lines.slice(0, k + 1).map((l) => l[l.length - 1])));
      part.tip.setAttribute("cx", tip[0]);
      part.tip.setAttribute("cy", -tip[1]);
      part.root.setAttribute("cx", line[0][0]);
      part.root.setAttribute("cy", -line[0][1]);
    }
  }
  let timer = null;
  function stop() {
    cancelAnimationFrame(timer);
    timer = null;
    button.textContent = "Play";
  }
  slider.max = data.t.length - 1;
  slider.value = Math.round(0.25 * slider.max);
  slider.addEventListener("input", () => { stop(); show(); });
  button.addEventListener("click", () => {
    if (timer !== null) return stop();
    button.textContent = "Pause";
    let k = Number(slider.value) >= slider.max ? 0 : Number(slider.value);
    const began = performance.now() - 1000 * data.t[k];
    const tick = (now) => {
      const t = (now - began) / 1000;
      while (k < slider.max && data.t[k + 1] <= t) k++;
      slider.value = k;
      show();
      if (k >= slider.max) return stop();
      timer = requestAnimationFrame(tick);
    };
    timer = requestAnimationFrame(tick);
  });
  show();
})();
