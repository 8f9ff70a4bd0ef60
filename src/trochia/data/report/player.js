// Playing the motion: the cursor runs in (a multiple of) real time.

const RATES = [0.1, 0.25, 0.5, 1, 2, 5, 10, 50, 100];
/** A job longer than this is played faster than it runs at first [s]. */
const PATIENCE = 60;

/**
 * @param {Motion} motion
 * @param {Store} store
 */
function attachPlayer(motion, store) {
  const [root, button, rate, slider] = ["player", "play", "rate", "time"].map((id) => document.getElementById(id));
  root.hidden = false;
  const length = motion.end - motion.start;
  const usual = RATES.find((value) => value >= 1 && length / value <= PATIENCE) ?? RATES[RATES.length - 1];
  rate.replaceChildren(...RATES.map((value) => new Option(`× ${value}`, String(value), false, value === usual)));
  [slider.min, slider.max, slider.value] = [motion.start, motion.end, motion.start];
  let before = null;

  function frame(now) {
    if (before === null) return;
    const time = (store.state.time ?? motion.start) + ((now - before) / 1000) * Number(rate.value);
    before = now;
    store.set({ time: Math.min(time, motion.end) });
    if (time >= motion.end) play(false);
    else requestAnimationFrame(frame);
  }

  function play(on) {
    button.textContent = on ? "Pause" : "Play";
    button.setAttribute("aria-pressed", String(on));
    if (!on) {
      before = null;
      return;
    }
    if (store.state.time === null || store.state.time >= motion.end) store.set({ time: motion.start });
    before = performance.now();
    requestAnimationFrame(frame);
  }

  button.addEventListener("click", () => play(before === null));
  slider.addEventListener("input", () => store.set({ time: Number(slider.value) }));
  store.subscribe(({ time }, changed) => {
    if (changed.has("time") && time !== null) slider.value = String(time);
  });
  document.addEventListener("keydown", (event) => {
    if (event.key !== " " || !(event.target instanceof HTMLCanvasElement)) return;
    event.preventDefault();
    play(before === null);
  });
}
