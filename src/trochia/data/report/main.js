// The page's beginning: reads the data, joins path, plots and tables, and wires the controls.

const LAYERS = [
  ["programmed", "Programmed", "programmed", "thin"],
  ["commanded", "Commanded", null, ""],
  ["actual", "Actual", "actual", ""],
  ["rapids", "Rapids", "rapid", "dashed"],
  ["dots", "Dots", "mark", "dot"],
  ["travel", "Travel", "travel", ""],
];
const GAINS = [1, 10, 100, 1000, 10000];

const byId = (id) => document.getElementById(id);

/** A button that is pressed or not. */
function toggle(text, pressed, swatch, kind, change) {
  const button = document.createElement("button");
  button.type = "button";
  button.setAttribute("aria-pressed", String(pressed));
  if (swatch) {
    const mark = button.appendChild(document.createElement("i"));
    mark.className = kind;
    mark.style.setProperty("--swatch", swatch);
  }
  button.append(text);
  button.addEventListener("click", () => change(button));
  return button;
}

function press(buttons, chosen) {
  for (const button of buttons) button.setAttribute("aria-pressed", String(button === chosen));
}

function wirePathTools(view, motion) {
  const planes = byId("planes");
  planes.hidden = view.camera.planes.length < 2;
  for (const plane of view.camera.planes) {
    planes.append(toggle(plane.name, plane === view.camera.plane, null, "", (button) => {
      press(planes.children, button);
      view.camera.setPlane(plane.name);
      view.fit();
    }));
  }
  byId("fit").addEventListener("click", () => view.fit());
  const has = { actual: Boolean(motion.path?.error), dots: motion.moves, commanded: motion.moves };
  for (const [key, text, colour, kind] of LAYERS) {
    if (has[key] === false) continue;
    byId("layers").append(toggle(text, true, colour ? `var(--${colour})` : "var(--axis-1)", kind, (button) => {
      view.shown[key] = !view.shown[key];
      button.setAttribute("aria-pressed", String(view.shown[key]));
      view.draw();
    }));
  }
  byId("dots-label").hidden = !motion.moves;
  const name = (interval) => (interval < 1 ? `${formatNumber(interval * 1000, 0)} ms` : `${interval} s`);
  const useful = DOT_INTERVALS.filter((interval) => (motion.end - motion.start) / interval <= MOST_DOTS);
  byId("dots").replaceChildren(
    ...useful.map((interval) => new Option(name(interval), String(interval), false, interval === view.interval)));
  byId("dots").addEventListener("change", (event) => view.setInterval(Number(event.target.value)));
  byId("gain-label").hidden = !has.actual;
  byId("gain").replaceChildren(...GAINS.map((gain) => new Option(gain === 1 ? "true size" : `× ${gain}`, String(gain))));
  byId("gain").addEventListener("change", (event) => {
    view.gain = Number(event.target.value);
    view.draw();
  });
}

function wireAxes(motion, store) {
  if (motion.axes.length < 2) return;
  motion.axes.forEach((axis, i) => {
    byId("axis-toggles").append(toggle(axis.name, true, `var(--axis-${i % 6})`, "", (button) => {
      const hidden = new Set(store.state.hidden);
      if (!hidden.delete(i)) hidden.add(i);
      button.setAttribute("aria-pressed", String(!hidden.has(i)));
      store.set({ hidden });
    }));
  });
}

/** Colours and numbers of the legend, in the theme and unit in force. */
function writeLegend(motion, theme, feed) {
  byId("legend-ramp").style.background = `linear-gradient(to right, ${theme.levels.join(",")})`;
  byId("legend-low").textContent = "0";
  byId("legend-high").textContent = formatNumber(motion.topFeed * FEED_UNITS[feed], feed === "mm/s" ? 1 : 0);
}

function wireFeed(motion, store, view) {
  const buttons = [...document.querySelectorAll("[data-feed]")];
  byId("legend").hidden = !motion.moves;
  for (const button of buttons) button.addEventListener("click", () => store.set({ feed: button.dataset.feed }));
  store.subscribe(({ feed }, changed) => {
    if (!changed.has("feed")) return;
    press(buttons, buttons.find((button) => button.dataset.feed === feed));
    writeSpeeds(feed);
    writeLegend(motion, view.theme, feed);
  });
}

/** The switch between colours of speed and of what binds, each with its legend. */
function wireColours(motion, view) {
  const buttons = [...document.querySelectorAll("[data-colours]")];
  byId("colours").hidden = !motion.limits || !motion.moves;
  for (const button of buttons) {
    button.addEventListener("click", () => {
      view.colours = button.dataset.colours;
      press(buttons, button);
      byId("legend").hidden = view.colours !== "speed";
      byId("limit-legend").hidden = view.colours !== "limit";
      view.draw();
    });
  }
}

/** @param {number} error [mm] */
function formatError(error) {
  return error < SMALL_ERROR ? `${formatFixed(error * 1000, 2)} µm` : `${formatFixed(error, 4)} mm`;
}

/** The parts of the read-out: line, time, position, speed, error. */
function readings(motion, state) {
  const now = motion.at(state.time);
  const parts = [["line", String(now.line)], ["", formatTime(now.time)]];
  motion.axes.forEach((axis, i) => parts.push([axis.name, formatFixed(now.position[i], 3)]));
  parts.push(["", `${formatFixed(now.speed * FEED_UNITS[state.feed], feedDigits(state.feed))} ${state.feed}`]);
  if (now.limit) parts.push(["bound by", now.limit]);
  if (now.error) parts.push(["error", formatError(Math.hypot(...now.error))]);
  return { parts, source: motion.text(now.line) };
}

function element(name, text, className = "") {
  const node = document.createElement(name);
  node.textContent = text;
  node.className = className;
  return node;
}

function wireReadout(motion, store, view) {
  const [readout, tip, canvas] = [byId("readout"), byId("tip"), view.canvases.base];
  let pointer = null;
  canvas.addEventListener("pointermove", (event) => {
    const box = canvas.getBoundingClientRect();
    pointer = event.buttons ? null : { x: event.clientX - box.left, y: event.clientY - box.top };
  }, { capture: true });
  const leave = () => {
    pointer = null;
    tip.hidden = true;
  };
  canvas.addEventListener("pointerleave", leave);
  canvas.addEventListener("pointerdown", leave);
  canvas.addEventListener("wheel", leave);

  const show = oncePerFrame(() => {
    if (store.state.time === null) return;
    const { parts, source } = readings(motion, store.state);
    const items = parts.map(([label, value]) => {
      const item = element("span", label ? `${label} ` : "");
      item.append(element("b", value));
      return item;
    });
    readout.replaceChildren(...items, element("code", source || " "));
    tip.hidden = pointer === null || view.pick(pointer.x, pointer.y) === null;
    if (tip.hidden) return;
    tip.replaceChildren(element("b", `line ${parts[0][1]}`), ` · ${parts[1][1]} · ${parts[2 + motion.axes.length][1]}`,
      element("code", source));
    const { clientWidth, clientHeight } = canvas;
    const x = Math.max(0, pointer.x + 16 + tip.offsetWidth > clientWidth ? pointer.x - tip.offsetWidth - 12 : pointer.x + 16);
    const y = pointer.y + 20 + tip.offsetHeight > clientHeight ? pointer.y - tip.offsetHeight - 12 : pointer.y + 20;
    tip.style.transform = `translate(${x}px, ${y}px)`;
  });
  store.subscribe((_, changed) => {
    if (changed.has("time") || changed.has("feed")) show();
  });
}

/** Redraw when the reader's theme changes, and in the colours of paper for printing. */
function wireTheme(motion, store, view, charts) {
  const refresh = () => {
    view.theme = new Theme();
    Chart.theme = view.theme;
    writeLegend(motion, view.theme, store.state.feed);
    view.render();  // at once: printing does not wait for a frame
    for (const chart of charts) chart.render();
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", refresh);
  const paper = (on) => {
    document.documentElement.toggleAttribute("data-paper", on);
    refresh();
  };
  addEventListener("beforeprint", () => paper(true));
  addEventListener("afterprint", () => paper(false));
}

function start() {
  const motion = new Motion(JSON.parse(byId("payload").textContent));
  const store = new Store({ time: null, window: [motion.start, motion.end], line: null, feed: "mm/s", hidden: new Set() });
  const view = new PathView({ base: byId("path-base"), over: byId("path-over") }, motion, store);
  byId("stage").hidden = view.empty;
  byId("path-empty").hidden = !view.empty;
  document.querySelector(".path .tools").hidden = view.empty;
  wirePathTools(view, motion);
  wireFeed(motion, store, view);
  wireColours(motion, view);
  attachPathInput(view, store);
  attachPathKeys(view);
  attachLines(store, motion);
  let charts = [];
  if (motion.moves) {
    charts = attachCharts(byId("charts"), motion, store);
    wireAxes(motion, store);
    wireReadout(motion, store, view);
    attachPlayer(motion, store);
  } else {
    document.querySelector(".plots").hidden = true;
    byId("readout").hidden = true;
  }
  byId("whole").addEventListener("click", () => showWindow(store, motion, motion.start, motion.end));
  store.subscribe(({ window: [from, to] }) => (byId("whole").disabled = to - from >= motion.end - motion.start));
  wireTheme(motion, store, view, charts);
  writeLegend(motion, view.theme, "mm/s");
  if (motion.path && motion.path.of > motion.path.time.length) {
    byId("thinned").hidden = false;
    byId("thinned").textContent = `Drawn from ${motion.path.time.length.toLocaleString("en")} of ` +
      `${motion.path.of.toLocaleString("en")} samples; peaks and corners are kept.`;
  }
}

start();
