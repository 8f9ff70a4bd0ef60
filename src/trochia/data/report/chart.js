// One plot over time: curves that keep their peaks at every zoom, limits as lines.

/** Room around the curves [CSS pixels]. */
const MARGIN = { left: 58, right: 10, top: 6, bottom: 19 };
/** A limit that the curves stay this far below is named, not drawn: it would flatten them. */
const LIMIT_IN_SIGHT = 0.3;

/**
 * @typedef {object} Series
 * @property {string} name
 * @property {number} axis           index of the axis, or -1
 * @property {Float32Array} values
 * @property {number|null} limit     drawn at ± limit, or at + limit alone where `oneSided`
 * @typedef {object} ChartSpec
 * @property {string} title
 * @property {string} unit
 * @property {Series[]} series
 * @property {boolean} oneSided      the quantity is never negative
 * @property {boolean} mapped        coloured as the path is
 */

class Chart {
  /**
   * @param {HTMLElement} parent
   * @param {ChartSpec} spec
   * @param {Motion} motion
   * @param {Store} store
   */
  constructor(parent, spec, motion, store) {
    Object.assign(this, { spec, motion, store });
    this.root = parent.appendChild(document.createElement("div"));
    this.root.className = "chart";
    this.root.innerHTML = `<div class="chart-head"><h3></h3><span class="unit"></span><span class="off"></span><span class="values"></span></div>
      <div class="plot"><canvas tabindex="0" role="img"></canvas><div class="hair" hidden></div><div class="band" hidden></div></div>`;
    const find = (name) => this.root.querySelector(name);
    [this.canvas, this.hair, this.band] = [find("canvas"), find(".hair"), find(".band")];
    [this.unit, this.off, this.values] = [find(".unit"), find(".off"), find(".values")];
    find("h3").textContent = spec.title;
    this.canvas.setAttribute("aria-label", `${spec.title} over time. Arrow keys move the cursor, plus and minus zoom.`);
    this.draw = oncePerFrame(() => this.render());
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  /** What is shown: series whose axis the reader has not left out. */
  get visible() {
    return this.spec.series.filter(({ axis }) => !this.store.state.hidden.has(axis));
  }

  /** The reader's unit and what one base unit is in it. */
  get factor() {
    return this.spec.unit === "mm/s" ? FEED_UNITS[this.store.state.feed] : 1;
  }

  /** @param {number} time [s] @returns {number} CSS pixels from the left */
  x(time) {
    const [from, to] = this.store.state.window;
    return MARGIN.left + ((time - from) / (to - from)) * (this.canvas.clientWidth - MARGIN.left - MARGIN.right);
  }

  /** @param {number} x CSS pixels from the left @returns {number} [s], inside the window */
  time(x) {
    const [from, to] = this.store.state.window;
    const share = (x - MARGIN.left) / (this.canvas.clientWidth - MARGIN.left - MARGIN.right);
    return from + Math.min(1, Math.max(0, share)) * (to - from);
  }

  /** First and last sample that the window touches. */
  #bounds() {
    const { time } = this.motion.channels;
    const [from, to] = this.store.state.window;
    return [lastNotAbove(time, from), Math.min(time.length - 1, lastNotAbove(time, to) + 1)];
  }

  /** Range of values in the window, limits included where the curves come near them. */
  #range() {
    const [first, last] = this.#bounds();
    let [low, high] = this.spec.oneSided ? [0, 0] : [Infinity, -Infinity];
    for (const { values } of this.visible) {
      for (let i = first; i <= last; i++) {
        if (values[i] < low) low = values[i];
        if (values[i] > high) high = values[i];
      }
    }
    if (!(high >= low)) [low, high] = [0, 1];
    const peak = Math.max(Math.abs(low), Math.abs(high));
    const limits = this.visible.map(({ limit }) => limit).filter((limit) => limit !== null);
    this.far = limits.filter((limit) => peak < LIMIT_IN_SIGHT * limit);
    for (const limit of limits.filter((limit) => peak >= LIMIT_IN_SIGHT * limit)) {
      high = Math.max(high, limit);
      if (!this.spec.oneSided) low = Math.min(low, -limit);
    }
    const room = 0.06 * (high - low) || Math.abs(high) * 0.1 || 1;
    return [this.spec.oneSided ? 0 : low - room, high + room];
  }

  /** Draw everything now; `draw` does so with the next frame. */
  render() {
    const { context, width, height } = prepareCanvas(this.canvas);
    const theme = Chart.theme;
    const [low, high] = this.#range();
    const floor = height - MARGIN.bottom;
    const y = (value) => floor - ((value - low) / (high - low)) * (floor - MARGIN.top);
    this.#drawGrid(context, theme, { width, floor, low, high, y });
    context.save();
    context.beginPath();
    context.rect(MARGIN.left, MARGIN.top - 2, width - MARGIN.left - MARGIN.right, floor - MARGIN.top + 4);
    context.clip();
    this.#drawChosenLine(context, theme, floor);
    for (const series of this.visible) this.#drawLimit(context, theme, series, y, width);
    for (const series of this.visible) this.#drawSeries(context, theme, series, y, floor);
    context.restore();
    this.unit.textContent = this.factor === 1 ? this.spec.unit : this.store.state.feed;
    this.off.textContent = this.#farText();
    this.showCursor();
  }

  /** Limits that are out of sight, in words. */
  #farText() {
    const digits = this.factor === 1 ? 1 : 0;
    const values = [...new Set(this.far)].map((limit) => formatNumber(limit * this.factor, digits));
    return values.length ? `limit ${values.join(", ")} far above` : "";
  }

  #drawGrid(context, theme, { width, floor, low, high, y }) {
    const [from, to] = this.store.state.window;
    context.lineWidth = 1;
    context.font = theme.font;
    context.strokeStyle = theme.get("grid");
    context.fillStyle = theme.get("soft");
    context.textAlign = "right";
    context.textBaseline = "middle";
    const factor = this.factor;
    const up = ticks(low * factor, high * factor, 4);
    for (const value of up.values) {
      const at = Math.round(y(value / factor)) + 0.5;
      context.strokeStyle = Math.abs(value) < 1e-12 ? theme.get("faint") : theme.get("grid");
      context.beginPath();
      context.moveTo(MARGIN.left, at);
      context.lineTo(width - MARGIN.right, at);
      context.stroke();
      context.fillText(formatFixed(value, up.digits), MARGIN.left - 6, at);
    }
    const across = ticks(from, to, (width - MARGIN.left) / 90);
    context.textAlign = "center";
    context.textBaseline = "top";
    context.strokeStyle = theme.get("grid");
    across.values.forEach((value, i) => {
      const at = Math.round(this.x(value)) + 0.5;
      context.beginPath();
      context.moveTo(at, MARGIN.top);
      context.lineTo(at, floor);
      context.stroke();
      const last = i === across.values.length - 1;
      if (at < width - 18) context.fillText(formatFixed(value, across.digits) + (last ? " s" : ""), at, floor + 5);
    });
  }

  /** Where the chosen source line is executed, as a tint. */
  #drawChosenLine(context, theme, floor) {
    const { line } = this.store.state;
    if (line === null || !this.motion.moves) return;
    context.fillStyle = theme.get("accent-soft");
    for (const [from, to] of this.motion.spans(line)) {
      const left = this.x(from);
      context.fillRect(left, MARGIN.top, Math.max(1.5, this.x(to) - left), floor - MARGIN.top);
    }
  }

  #drawLimit(context, theme, { axis, limit }, y, width) {
    if (limit === null || this.far.includes(limit)) return;
    context.strokeStyle = axis < 0 ? theme.get("ink") : theme.axis(axis);
    context.globalAlpha = 0.75;
    context.lineWidth = 1.2;
    context.setLineDash([7, 4]);
    for (const value of this.spec.oneSided ? [limit] : [limit, -limit]) {
      context.beginPath();
      context.moveTo(MARGIN.left, y(value));
      context.lineTo(width - MARGIN.right, y(value));
      context.stroke();
    }
    context.setLineDash([]);
    context.globalAlpha = 1;
  }

  /**
   * One curve: where a pixel column holds several samples it is drawn from the first by the least and the greatest to
   * the last of them, so that no peak vanishes.
   */
  #drawSeries(context, theme, { axis, values }, y, floor) {
    const { time } = this.motion.channels;
    const [first, last] = this.#bounds();
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    context.strokeStyle = this.spec.mapped ? this.#ramp(context, theme, y) : this.colour(axis);
    context.beginPath();
    for (let i = first; i <= last; ) {
      const column = Math.floor(this.x(time[i]));
      let [low, high, end] = [values[i], values[i], i];
      while (end < last && Math.floor(this.x(time[end + 1])) === column) {
        end++;
        if (values[end] < low) low = values[end];
        if (values[end] > high) high = values[end];
      }
      const at = end === i ? this.x(time[i]) : column + 0.5;
      for (const value of end === i ? [low] : [values[i], low, high, values[end]]) context.lineTo(at, y(value));
      i = end + 1;
    }
    context.stroke();
    if (!this.spec.mapped || onPaper()) return; // what is pale on a screen prints solid
    context.lineTo(this.x(time[last]), floor);
    context.lineTo(this.x(time[first]), floor);
    context.globalAlpha = 0.16;
    context.fillStyle = context.strokeStyle;
    context.fill();
    context.globalAlpha = 1;
  }

  /** The path's colours, by height. */
  #ramp(context, theme, y) {
    const ramp = context.createLinearGradient(0, y(0), 0, y(this.motion.topFeed));
    for (const [at, colour] of theme.stops()) ramp.addColorStop(at, colour);
    return ramp;
  }

  /** @param {number} axis @returns {string} */
  colour(axis) {
    return axis < 0 ? Chart.theme.get("ink") : Chart.theme.axis(axis);
  }

  /** Put the cursor and the values under it. */
  showCursor() {
    const { time, window: [from, to] } = this.store.state;
    const seen = time !== null && time >= from && time <= to;
    this.hair.hidden = !seen;
    if (seen) this.hair.style.transform = `translateX(${this.x(time)}px)`;
    const index = time === null ? null : lastNotAbove(this.motion.channels.time, time);
    this.values.replaceChildren(...this.visible.map((series) => this.#value(series, index)));
  }

  /** A value under the cursor, or the series' name alone. */
  #value({ name, axis, values }, index) {
    const item = document.createElement("span");
    item.style.color = this.spec.mapped ? "" : this.colour(axis);
    const digits = this.spec.unit === "mm/s" ? feedDigits(this.store.state.feed) : this.spec.digits;
    item.textContent = index === null ? name : `${name} ${formatFixed(values[index] * this.factor, digits)}`.trim();
    return item;
  }
}
