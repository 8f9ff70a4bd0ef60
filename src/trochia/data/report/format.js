// Numbers as text: the same on path, plots and tables.

/**
 * A number with at most `digits` decimals and a true minus sign; never "-0".
 * @param {number} value
 * @param {number} digits
 * @returns {string}
 */
function formatNumber(value, digits) {
  const text = value.toFixed(digits);
  const short = text.includes(".") ? text.replace(/\.?0+$/, "") : text;
  return short === "-0" ? "0" : short.replace("-", "−");
}

/**
 * A number with `digits` decimals, all shown, so that a changing value does not dance.
 * @param {number} value
 * @param {number} digits
 * @returns {string}
 */
function formatFixed(value, digits) {
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−");
}

/**
 * How many decimals tell values apart in a range of this size.
 * @param {number} span
 * @returns {number}
 */
function decimalsFor(span) {
  return span > 0 ? Math.min(6, Math.max(0, 3 - Math.floor(Math.log10(span)))) : 3;
}

/**
 * A time, in milliseconds below a second where the step asks for it.
 * @param {number} seconds
 * @param {number} digits
 * @returns {string}
 */
function formatTime(seconds, digits = 3) {
  if (seconds < 60) return `${formatFixed(seconds, digits)} s`;
  const minutes = Math.floor(seconds / 60);
  const rest = (seconds - 60 * minutes).toFixed(digits).padStart(digits ? digits + 3 : 2, "0");
  if (minutes < 60) return `${minutes}:${rest} min`;
  return `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, "0")}:${rest} h`;
}

/** Units of feed the reader may choose, and what one mm/s is in them. */
const FEED_UNITS = { "mm/s": 1, "mm/min": 60 };

/**
 * Decimals for a feed in the chosen unit.
 * @param {string} unit
 * @returns {number}
 */
function feedDigits(unit) {
  return unit === "mm/s" ? 2 : 0;
}
