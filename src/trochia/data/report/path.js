// The path view: layers, what is under the pointer, and marks of the cursor and the chosen line.

/** Intervals between equal-time dots that the reader may choose [s]. */
const DOT_INTERVALS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60];
/** Beyond these dots no drawing is clearer. */
const MOST_DOTS = 20000;
/** How far from the path the pointer still means it [CSS pixels]. */
const REACH = 28;

class PathView {
  /**
   * @param {{base: HTMLCanvasElement, over: HTMLCanvasElement}} canvases
   * @param {Motion} motion
   * @param {Store} store
   */
  constructor(canvases, motion, store) {
    Object.assign(this, { canvases, motion, store });
    this.extent = this.#extent();
    this.camera = new Camera(motion.axes, (axis) => (this.extent ? this.extent[axis][1] - this.extent[axis][0] : 0));
    this.runs = motion.moves ? { speed: speedRuns(motion), limit: motion.limits ? limitRuns(motion) : null } : null;
    /** What the colours of the commanded path say: "speed" or "limit". */
    this.colours = "speed";
    this.shown = { programmed: true, commanded: true, actual: true, rapids: true, dots: true, travel: true };
    this.gain = 1;
    this.interval = this.#usualInterval();
    this.dots = this.#dots();
    this.theme = new Theme();
    this.draw = oncePerFrame(() => this.render());
    this.drawMarks = oncePerFrame(() => this.#drawMarks());
    this.fitted = true;
    store.subscribe((_, changed) => {
      if (changed.has("window")) this.draw();
      else if (changed.has("time") || changed.has("line")) this.drawMarks();
    });
    new ResizeObserver(() => this.#resized()).observe(canvases.base);
  }

  get empty() {
    return this.extent === null || this.camera.plane === null;
  }

  /** Lowest and highest value of every axis over all that is drawn. */
  #extent() {
    const tables = [this.motion.programmed, this.motion.path].filter((part) => part && part.position[0]?.length);
    if (!tables.length) return null;
    return this.motion.axes.map((_, axis) => {
      let [low, high] = [Infinity, -Infinity];
      for (const { position } of tables) {
        for (const value of position[axis]) {
          if (value < low) low = value;
          if (value > high) high = value;
        }
      }
      return [low, high];
    });
  }

  /** The interval that gives some three hundred dots. */
  #usualInterval() {
    const wanted = (this.motion.end - this.motion.start) / 300;
    return DOT_INTERVALS.find((interval) => interval >= wanted) ?? DOT_INTERVALS[DOT_INTERVALS.length - 1];
  }

  /** Positions at equal times, where the position has changed, as columns. */
  #dots() {
    const { motion } = this;
    const columns = motion.axes.map(() => []);
    if (!motion.moves) return columns;
    const count = Math.min(MOST_DOTS, Math.floor((motion.end - motion.start) / this.interval + 1e-9));
    let before = null;
    for (let i = 0; i <= count; i++) {
      const { position } = motion.at(motion.start + i * this.interval);
      const moved = before === null || position.some((value, axis) => Math.abs(value - before[axis]) > 1e-6);
      if (moved) position.forEach((value, axis) => columns[axis].push(value));
      before = position;
    }
    return columns;
  }

  /** @param {number} interval [s] */
  setInterval(interval) {
    this.interval = interval;
    this.dots = this.#dots();
    this.draw();
  }

  /** Show all of the path. */
  fit() {
    if (this.empty) return;
    this.camera.fit(boxCorners(this.camera.columns, this.extent, this.motion.axes.length));
    this.fitted = true;
    this.draw();
  }

  /** The reader moved the view; it keeps its place from now on. */
  moved() {
    this.fitted = false;
    this.draw();
  }

  #resized() {
    const { clientWidth, clientHeight } = this.canvases.base;
    this.camera.resize(clientWidth, clientHeight);
    if (this.fitted) this.fit();
    else this.draw();
  }

  /** Draw everything now; `draw` does so with the next frame. */
  render() {
    if (this.empty) return;
    const { context } = prepareCanvas(this.canvases.base);
    const { camera, motion, theme, shown } = this;
    if (!camera.orbiting) {
      const names = [camera.right, camera.up].map((side) => motion.axes[camera.columns[side.indexOf(1)] ?? 0].name);
      drawPaper(context, camera, theme, names);
    }
    context.lineJoin = context.lineCap = "round";
    if (shown.travel) drawTravel(context, camera, motion.axes, theme);
    this.#drawProgrammed(context);
    this.screen = motion.moves ? camera.project(motion.path.position, motion.path.time.length) : null;
    if (this.screen) this.#drawMotion(context);
    context.setLineDash([]);
    const ends = motion.moves ? motion.path : motion.programmed;
    const at = (index) => ends.position.map((column) => column[index]);
    drawEnds(context, camera, at(0), at(ends.position[0].length - 1), theme);
    drawScaleBar(context, camera, theme);
    if (camera.orbiting) drawTriad(context, camera, motion.axes, theme);
    if (onPaper()) this.#drawMarksOn(context);
    else this.#drawMarks();
  }

  #drawProgrammed(context) {
    const { programmed } = this.motion;
    if (!programmed || !programmed.line.length) return;
    const points = this.camera.project(programmed.position, programmed.line.length);
    context.lineWidth = 1;
    if (this.shown.programmed) {
      context.strokeStyle = this.theme.get("programmed");
      strokeRuns(context, points, (i) => !programmed.rapid[i + 1]);
    }
    if (this.shown.rapids && !this.motion.moves) {
      context.strokeStyle = this.theme.get("rapid");
      context.setLineDash([6, 5]);
      strokeRuns(context, points, (i) => programmed.rapid[i + 1] === 1);
      context.setLineDash([]);
    }
  }

  #drawMotion(context) {
    const { motion, shown, theme, screen } = this;
    const [first, last] = this.#bounds();
    const whole = first === 0 && last === screen.x.length - 1;
    const actual = shown.actual && motion.path.error ? () => this.#drawActual(context, first, last) : () => {};
    if (this.gain === 1) actual();
    const byLimit = this.colours === "limit";
    if (shown.commanded) {
      const [runs, colours] = byLimit ? [this.runs.limit, theme.limits] : [this.runs.speed, theme.levels];
      context.lineWidth = byLimit ? 3.2 : 2.6;
      if (!whole) {
        context.globalAlpha = 0.14;
        runs.stroke(context, screen, colours, [0, screen.x.length - 1]);
        context.globalAlpha = 1;
      }
      runs.stroke(context, screen, colours, [first, last]);
    }
    if (shown.rapids && !byLimit) {
      const rapid = (i) => i >= first && i < last && motion.path.rapid[i + 1] === 1;
      // paper first: between the dashes the actual path shows only where it leaves the commanded one
      for (const [width, colour, dashes] of [[2.6, "paper", []], [1.6, "rapid", [6, 5]]]) {
        context.lineWidth = width;
        context.strokeStyle = theme.get(colour);
        context.setLineDash(dashes);
        strokeRuns(context, screen, rapid);
      }
      context.setLineDash([]);
    }
    if (this.gain !== 1) actual();
    if (shown.dots && !byLimit) this.#drawDots(context);  // they would hide short stretches of a colour
  }

  /** Where the machine was; its distance beside the path drawn `gain` times as large. */
  #drawActual(context, first, last) {
    const { position, error, deviation, time } = this.motion.path;
    const beyond = this.gain - 1;
    const table = position.map((column, axis) => column.map((value, i) => value + error[axis][i] + beyond * deviation[axis][i]));
    context.lineWidth = 1.3;
    context.strokeStyle = this.theme.get("actual");
    strokeRuns(context, this.camera.project(table, time.length), (i) => i >= first && i < last);
  }

  #drawDots(context) {
    const points = this.camera.project(this.dots, this.dots[0].length);
    context.fillStyle = this.theme.get("mark");
    context.beginPath();
    for (let i = 0; i < points.x.length; i++) {
      context.moveTo(points.x[i] + 1.7, points.y[i]);
      context.arc(points.x[i], points.y[i], 1.7, 0, 2 * Math.PI);
    }
    context.fill();
  }

  /** First and last point inside the times the plots show. */
  #bounds() {
    const { time } = this.motion.path;
    const [from, to] = this.store.state.window;
    return [lastNotAbove(time, from), Math.min(time.length - 1, lastNotAbove(time, to) + (to < this.motion.end ? 1 : 0))];
  }

  #drawMarks() {
    if (this.empty) return;
    this.#drawMarksOn(prepareCanvas(this.canvases.over).context);
  }

  #drawMarksOn(context) {
    const { time, line } = this.store.state;
    context.lineJoin = context.lineCap = "round";
    if (line !== null) this.#drawLine(context, line);
    if (time === null || !this.screen) return;
    const [x, y] = this.camera.screen(this.motion.at(time).position);
    context.lineWidth = 5;
    context.strokeStyle = this.theme.get("paper");
    context.beginPath();
    context.arc(x, y, 7, 0, 2 * Math.PI);
    context.stroke();
    context.lineWidth = 2.5;
    context.strokeStyle = this.theme.get("mark");
    context.stroke();
  }

  /** The moves of a source line, broad and in the accent colour. */
  #drawLine(context, line) {
    const { programmed, path } = this.motion;
    const part = programmed && programmed.line.includes(line) ? programmed : path;
    if (!part) return;
    const points = this.camera.project(part.position, part.line.length);
    for (const [width, colour] of [[9, this.theme.get("paper")], [5, this.theme.get("accent")]]) {
      context.lineWidth = width;
      context.strokeStyle = colour;
      strokeRuns(context, points, (i) => part.line[i + 1] === line);
    }
  }

  /**
   * The instant of the path nearest to a point of the screen, or null if none is near.
   * @param {number} px @param {number} py [CSS pixels]
   * @returns {number|null} [s]
   */
  pick(px, py) {
    if (!this.screen) return null;
    const { x, y } = this.screen;
    const { time } = this.motion.path;
    const [first, last] = this.#bounds();
    let nearest = REACH * REACH;
    let found = null;
    for (let i = first; i < last; i++) {
      const [dx, dy] = [x[i + 1] - x[i], y[i + 1] - y[i]];
      const square = dx * dx + dy * dy;
      const share = square > 0 ? Math.min(1, Math.max(0, ((px - x[i]) * dx + (py - y[i]) * dy) / square)) : 0;
      const distance = (x[i] + share * dx - px) ** 2 + (y[i] + share * dy - py) ** 2;
      if (distance < nearest) {
        nearest = distance;
        found = time[i] + share * (time[i + 1] - time[i]);
      }
    }
    return found;
  }
}
