// Pointer, wheel and keys on the path: pan, pinch, zoom, orbit, and pointing at an instant.

const ZOOM_KEY = 1.25;
const PAN_KEY = 40;
const ORBIT_PER_PIXEL = 0.008;

/**
 * @param {PathView} view
 * @param {Store} store
 */
function attachPathInput(view, store) {
  const canvas = view.canvases.base;
  /** @type {Map<number, {x: number, y: number}>} */
  const pointers = new Map();
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };

  function point({ x, y }) {
    const time = view.pick(x, y);
    if (time !== null) store.set({ time });
    return time;
  }

  function drag(before, now, shift) {
    const [dx, dy] = [now.x - before.x, now.y - before.y];
    if (view.camera.orbiting && !shift) view.camera.orbit(-dx * ORBIT_PER_PIXEL, dy * ORBIT_PER_PIXEL);
    else view.camera.pan(dx, dy);
    view.moved();
  }

  function pinch(event, now) {
    const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
    const before = pointers.get(event.pointerId);
    const spread = (at) => Math.hypot(at.x - other.x, at.y - other.y) || 1;
    view.camera.pan((now.x - before.x) / 2, (now.y - before.y) / 2);
    view.camera.zoom(spread(now) / spread(before), (now.x + other.x) / 2, (now.y + other.y) / 2);
    view.moved();
  }

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    canvas.classList.add("dragging");
    if (event.pointerType !== "mouse") point(place(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    const now = place(event);
    const before = pointers.get(event.pointerId);
    if (!before) {
      point(now);
      return;
    }
    if (pointers.size > 1) pinch(event, now);
    else drag(before, now, event.shiftKey);
    pointers.set(event.pointerId, now);
  });
  for (const kind of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(kind, (event) => {
      pointers.delete(event.pointerId);
      canvas.classList.toggle("dragging", pointers.size > 0);
    });
  }
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const { x, y } = place(event);
    view.camera.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), x, y);
    view.moved();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => view.fit());
}

/**
 * Keys on the path: arrows pan, plus and minus zoom, F fits.
 * @param {PathView} view
 */
function attachPathKeys(view) {
  const canvas = view.canvases.base;
  const keys = {
    "+": () => view.camera.zoom(ZOOM_KEY),
    "=": () => view.camera.zoom(ZOOM_KEY),
    "-": () => view.camera.zoom(1 / ZOOM_KEY),
    ArrowLeft: () => view.camera.pan(PAN_KEY, 0),
    ArrowRight: () => view.camera.pan(-PAN_KEY, 0),
    ArrowUp: () => view.camera.pan(0, PAN_KEY),
    ArrowDown: () => view.camera.pan(0, -PAN_KEY),
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key.toLowerCase() === "f") view.fit();
    else if (event.key in keys) {
      keys[event.key]();
      view.moved();
    } else return;
    event.preventDefault();
  });
}
