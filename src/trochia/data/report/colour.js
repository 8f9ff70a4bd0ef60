// Colours: the theme's from the style sheet, the speed's from a perceptually uniform map.

/** Viridis (Smith and van der Walt, 2015, CC0), dark to bright, lightness rising evenly. */
const VIRIDIS = [
  "#440154", "#48186a", "#472d7b", "#424086", "#3b528b", "#33638d", "#2c728e", "#26828e", "#21918c",
  "#1fa088", "#28ae80", "#3fbc73", "#5ec962", "#84d44b", "#addc30", "#d8e219", "#fde725",
].map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)));

/** How many colours a path is drawn in; the eye tells no more. */
const LEVELS = 48;

/** Groups of limits in the order of their colours, `--limit-…` of the style sheet. */
const LIMIT_GROUPS = ["feed", "velocity", "acceleration", "jerk", "bend", "stop", "path", "other"];

/** Reads the theme that is in force; ask again when it changes. */
class Theme {
  constructor() {
    const style = getComputedStyle(document.documentElement);
    /** @type {(name: string) => string} */
    this.get = (name) => style.getPropertyValue(`--${name}`).trim();
    const from = Number(this.get("map-from"));
    const to = Number(this.get("map-to"));
    this.levels = Array.from({ length: LEVELS }, (_, i) => mapColour(from + ((to - from) * i) / (LEVELS - 1)));
    this.limits = LIMIT_GROUPS.map((group) => this.get(`limit-${group}`));
    this.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  }

  /** @param {number} index of the axis */
  axis(index) {
    return this.get(`axis-${index % 6}`);
  }

  /** The map as stops of a CSS or canvas gradient. */
  stops() {
    return this.levels.map((colour, i) => [i / (LEVELS - 1), colour]);
  }
}

/**
 * @param {number} share 0 to 1
 * @returns {string}
 */
function mapColour(share) {
  const place = Math.min(1, Math.max(0, share)) * (VIRIDIS.length - 1);
  const index = Math.min(VIRIDIS.length - 2, Math.floor(place));
  const mix = (a, b) => Math.round(a + (place - index) * (b - a));
  return `rgb(${VIRIDIS[index].map((part, i) => mix(part, VIRIDIS[index + 1][i])).join(" ")})`;
}

/**
 * @param {number} speed
 * @param {number} top speed of the brightest colour
 * @returns {number} level, 0 to LEVELS - 1
 */
function speedLevel(speed, top) {
  return Math.min(LEVELS - 1, Math.max(0, Math.round((speed / top) * (LEVELS - 1))));
}
