// Round numbers for axes and rulers, and canvases as sharp as the screen.

/**
 * The greatest of 1, 2, 5 × 10^n that is not above `rough`.
 * @param {number} rough
 * @returns {number}
 */
function niceStep(rough) {
  const decade = 10 ** Math.floor(Math.log10(rough));
  const factor = rough / decade;
  return decade * (factor >= 5 ? 5 : factor >= 2 ? 2 : 1);
}

/**
 * Round values between `low` and `high`, about `wanted` of them.
 * @param {number} low
 * @param {number} high
 * @param {number} wanted
 * @returns {{values: number[], digits: number}}
 */
function ticks(low, high, wanted) {
  if (!(high > low)) return { values: [low], digits: 3 };
  const rough = (high - low) / Math.max(1, wanted);
  let step = niceStep(rough);
  if (step < 0.8 * rough) step = niceStep(2.6 * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const values = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + step * 1e-9; i++) values.push(i * step);
  return { values, digits };
}

/** The page is being printed. */
function onPaper() {
  return document.documentElement.hasAttribute("data-paper");
}

/**
 * Give a canvas as many pixels as the screen shows of it, and return its context in CSS pixels, cleared.
 * @param {HTMLCanvasElement} canvas
 * @returns {{context: CanvasRenderingContext2D, width: number, height: number}}
 */
function prepareCanvas(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (onPaper() || canvas.width !== across || canvas.height !== down) {
    canvas.width = across; // a fresh canvas: browsers print what is drawn on it as vectors, and paper knows no clearing
    canvas.height = down;
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  if (!onPaper()) context.clearRect(0, 0, width, height);
  return { context, width, height };
}
