// The motion as the page was given it: arrays out of base64, and questions about an instant or a line.

const PAYLOAD_FORMAT = 1;
const ARRAY_TYPES = { f4: Float32Array, f8: Float64Array, i4: Int32Array, u1: Uint8Array };

/**
 * @param {{type: string, data: string}} packed
 * @returns {Float32Array|Float64Array|Int32Array|Uint8Array}
 */
function unpack(packed) {
  const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
  return new ARRAY_TYPES[packed.type](bytes.buffer);
}

/** All packed arrays of a JSON value, unpacked; the rest as it is. */
function unpackAll(value) {
  if (Array.isArray(value)) return value.map(unpackAll);
  if (value === null || typeof value !== "object") return value;
  if (typeof value.data === "string" && value.type in ARRAY_TYPES) return unpack(value);
  return Object.fromEntries(Object.entries(value).map(([key, part]) => [key, unpackAll(part)]));
}

/**
 * Index of the last element not above `value` (0 if all are).
 * @param {ArrayLike<number>} sorted
 * @param {number} value
 * @returns {number}
 */
function lastNotAbove(sorted, value) {
  let low = 0;
  let high = sorted.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (sorted[middle] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
}

class Motion {
  /** @param {object} payload the page's JSON object */
  constructor(payload) {
    if (payload.format !== PAYLOAD_FORMAT) throw new Error(`unknown payload format ${payload.format}`);
    this.axes = payload.axes;
    this.caps = payload.caps;
    this.lines = payload.lines;
    this.programmed = unpackAll(payload.programmed);
    this.path = unpackAll(payload.path);
    this.limits = payload.limits;
    this.channels = unpackAll(payload.channels);
    const time = this.path ? this.path.time : [];
    this.start = time.length ? time[0] : 0;
    this.end = time.length ? time[time.length - 1] : 0;
    this.moves = time.length > 1;
    this.topFeed = this.#topSpeed();
  }

  /** Greatest speed the colours must span: of feed motion, or of all motion where nothing is fed. */
  #topSpeed() {
    let feed = 0;
    let any = 0;
    if (this.path) {
      this.path.speed.forEach((speed, i) => {
        any = Math.max(any, speed);
        if (!this.path.rapid[i]) feed = Math.max(feed, speed);
      });
    }
    return feed || any || 1;
  }

  /**
   * The motion at an instant, between samples by straight lines.
   * @param {number} time [s]
   * @returns {{time: number, index: number, position: number[], error: number[]|null, speed: number, line: number,
   *   limit: string}}
   */
  at(time) {
    const { time: times, position, error, speed, line, limit } = this.path;
    const index = Math.min(lastNotAbove(times, time), times.length - 2);
    const weight = Math.min(1, Math.max(0, (time - times[index]) / (times[index + 1] - times[index])));
    const between = (values) => values[index] + weight * (values[index + 1] - values[index]);
    return {
      time,
      index,
      position: position.map(between),
      error: error ? error.map(between) : null,
      speed: between(speed),
      limit: limit ? this.limits[limit[weight < 0.5 ? index : index + 1]].text : "",
      line: line[weight < 0.5 ? index : index + 1],
    };
  }

  /**
   * The spans of time in which a line is executed.
   * @param {number} line
   * @returns {Array<[number, number]>} [s]
   */
  spans(line) {
    const { time, line: lines } = this.path;
    const spans = [];
    for (let i = 0; i < lines.length; i++) {
      if (lines[i] !== line) continue;
      const first = i;
      while (i + 1 < lines.length && lines[i + 1] === line) i++;
      spans.push([time[first], time[Math.min(i + 1, time.length - 1)]]);
    }
    return spans;
  }

  /**
   * Text of a source line; empty when it was not embedded.
   * @param {number} line
   * @returns {string}
   */
  text(line) {
    return this.lines[line] ?? "";
  }
}
