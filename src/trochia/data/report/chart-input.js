// Pointer and keys on a plot: the cursor in time, and zooming by dragging.

/** A drag shorter than this is a click [CSS pixels]. */
const LEAST_DRAG = 5;
/** No window is shorter than this [s]. */
const LEAST_WINDOW = 1e-4;

/**
 * Show a window of time, cut to the motion.
 * @param {Store} store
 * @param {Motion} motion
 * @param {number} from
 * @param {number} to
 */
function showWindow(store, motion, from, to) {
  const length = Math.min(motion.end - motion.start, Math.max(LEAST_WINDOW, to - from));
  const begin = Math.min(motion.end - length, Math.max(motion.start, from));
  store.set({ window: [begin, begin + length] });
}

/**
 * Zoom about an instant.
 * @param {number} factor of the window's length
 */
function zoomTime(store, motion, factor, about) {
  const [from, to] = store.state.window;
  showWindow(store, motion, about - (about - from) * factor, about + (to - about) * factor);
}

/**
 * @param {Chart} chart
 * @param {Motion} motion
 * @param {Store} store
 */
function attachChartInput(chart, motion, store) {
  const { canvas, band } = chart;
  let begun = null;
  const place = (event) => event.clientX - canvas.getBoundingClientRect().left;

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    begun = place(event);
    store.set({ time: chart.time(begun) });
  });
  canvas.addEventListener("pointermove", (event) => {
    const x = place(event);
    store.set({ time: chart.time(x) });
    if (begun === null) return;
    const [left, right] = [Math.min(begun, x), Math.max(begun, x)].map((at) => chart.x(chart.time(at)));
    band.hidden = right - left < LEAST_DRAG;
    band.style.left = `${left}px`;
    band.style.width = `${right - left}px`;
  });
  canvas.addEventListener("pointerup", (event) => {
    const x = place(event);
    band.hidden = true;
    if (begun !== null && Math.abs(x - begun) >= LEAST_DRAG) {
      showWindow(store, motion, chart.time(Math.min(begun, x)), chart.time(Math.max(begun, x)));
    }
    begun = null;
  });
  canvas.addEventListener("pointercancel", () => {
    begun = null;
    band.hidden = true;
  });
  canvas.addEventListener("dblclick", () => showWindow(store, motion, motion.start, motion.end));
}

/**
 * Keys on a plot: arrows move the cursor, plus and minus zoom about it, Escape shows all.
 * @param {HTMLCanvasElement} canvas
 * @param {Motion} motion
 * @param {Store} store
 */
function attachChartKeys(canvas, motion, store) {
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const [from, to] = store.state.window;
    const time = store.state.time ?? from;
    const step = ((to - from) / 200) * (event.shiftKey ? 10 : 1);
    const move = (by) => {
      const at = Math.min(motion.end, Math.max(motion.start, time + by));
      store.set({ time: at });
      if (at < from || at > to) showWindow(store, motion, from + by, to + by);
    };
    const keys = {
      ArrowLeft: () => move(-step),
      ArrowRight: () => move(step),
      Home: () => move(motion.start - time),
      End: () => move(motion.end - time),
      "+": () => zoomTime(store, motion, 0.5, time),
      "=": () => zoomTime(store, motion, 0.5, time),
      "-": () => zoomTime(store, motion, 2, time),
      Escape: () => showWindow(store, motion, motion.start, motion.end),
    };
    if (!(event.key in keys)) return;
    keys[event.key]();
    event.preventDefault();
  });
}
