// Where the reader stands: a parallel projection of up to three linear axes onto the screen, panned and zoomed.

/** @typedef {{name: string, axes: number[], right: number[], up: number[]}} Plane */

class Camera {
  /**
   * @param {Array<{name: string, unit: string}>} axes of the machine
   * @param {(axis: number) => number} depth extent of the motion along an axis [mm]
   */
  constructor(axes, depth) {
    /** Columns of the axes that are drawn. */
    this.columns = axes.map((axis, i) => (axis.unit === "mm" ? i : -1)).filter((i) => i >= 0).slice(0, 3);
    this.planes = Camera.#planes(axes, this.columns, depth);
    this.azimuth = -0.6;
    this.elevation = 0.6;
    this.scale = 1;
    this.centre = [0, 0];
    const spread = (plane) => this.columns.every((column, i) => !plane.right[i] && !plane.up[i] || depth(column) > 0);
    const first = this.planes.find((plane) => plane.right && spread(plane)) ?? this.planes[0];
    this.setPlane(first ? first.name : "");
  }

  /** The views a machine offers: planes of its axes as a drawing shows them, and all round where there is depth. */
  static #planes(axes, columns, depth) {
    const unit = (i) => columns.map((_, place) => (place === i ? 1 : 0));
    const plane = (a, b) => ({ name: axes[columns[a]].name + axes[columns[b]].name, right: unit(a), up: unit(b) });
    if (columns.length === 0) return [];
    if (columns.length === 1) return [{ name: axes[columns[0]].name, right: [1], up: [0] }];
    if (columns.length === 2) {
      // a lathe is drawn with its spindle across the page
      return axes[columns[1]].name === "Z" ? [plane(1, 0)] : [plane(0, 1)];
    }
    const planes = [plane(0, 1), plane(0, 2), plane(1, 2)];
    const flat = columns.filter((column) => depth(column) <= 0).length;
    if (!flat) planes.push({ name: "3D", right: null, up: null });
    return planes;
  }

  /** @param {string} name of one of `planes` */
  setPlane(name) {
    this.plane = this.planes.find((plane) => plane.name === name) ?? null;
    this.#turn();
  }

  get orbiting() {
    return this.plane !== null && this.plane.right === null;
  }

  /** Turn the view all round by so many radians. */
  orbit(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.elevation + elevation));
    this.#turn();
  }

  #turn() {
    if (!this.plane) return;
    if (!this.orbiting) {
      [this.right, this.up] = [this.plane.right, this.plane.up];
      return;
    }
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    this.right = [ca, -sa, 0];
    this.up = [sa * se, ca * se, ce];
  }

  /**
   * @param {ArrayLike<number>} point position of all axes of the machine
   * @returns {[number, number]} across and up [mm]
   */
  flatten(point) {
    let across = 0;
    let up = 0;
    this.columns.forEach((column, i) => {
      across += this.right[i] * point[column];
      up += this.up[i] * point[column];
    });
    return [across, up];
  }

  /**
   * All points of a table of columns on the screen.
   * @param {Array<ArrayLike<number>>} table a column per axis
   * @param {number} count
   * @returns {{x: Float32Array, y: Float32Array}} CSS pixels
   */
  project(table, count) {
    const x = new Float32Array(count);
    const y = new Float32Array(count);
    const [ox, oy] = this.#origin();
    const parts = this.columns.map((column, i) => [table[column], this.right[i], this.up[i]]);
    for (let n = 0; n < count; n++) {
      let across = 0;
      let up = 0;
      for (const [values, right, above] of parts) {
        across += right * values[n];
        up += above * values[n];
      }
      x[n] = ox + this.scale * across;
      y[n] = oy - this.scale * up;
    }
    return { x, y };
  }

  /** @param {ArrayLike<number>} point @returns {[number, number]} CSS pixels */
  screen(point) {
    const [across, up] = this.flatten(point);
    const [ox, oy] = this.#origin();
    return [ox + this.scale * across, oy - this.scale * up];
  }

  #origin() {
    return [this.width / 2 - this.scale * this.centre[0], this.height / 2 + this.scale * this.centre[1]];
  }

  /** The world under the screen's edges: left, right, bottom, top [mm]. */
  window() {
    const [w, h] = [this.width / (2 * this.scale), this.height / (2 * this.scale)];
    return [this.centre[0] - w, this.centre[0] + w, this.centre[1] - h, this.centre[1] + h];
  }

  /** @param {number} width @param {number} height of the stage [CSS pixels] */
  resize(width, height) {
    this.width = width;
    this.height = height;
  }

  /** @param {number} dx @param {number} dy [CSS pixels] */
  pan(dx, dy) {
    this.centre = [this.centre[0] - dx / this.scale, this.centre[1] + dy / this.scale];
  }

  /** Zoom by `factor`, the point under (x, y) staying where it is. */
  zoom(factor, x = this.width / 2, y = this.height / 2) {
    const scale = Math.min(1e6, Math.max(1e-4, this.scale * factor));
    const [across, down] = [x - this.width / 2, y - this.height / 2];
    this.centre = [
      this.centre[0] + across / this.scale - across / scale,
      this.centre[1] - down / this.scale + down / scale,
    ];
    this.scale = scale;
  }

  /**
   * Show all of a box given by its corners.
   * @param {number[][]} corners points of all axes
   * @param {number} margin [CSS pixels]
   */
  fit(corners, margin = 44) {
    const flat = corners.map((corner) => this.flatten(corner));
    const [us, vs] = [flat.map((p) => p[0]), flat.map((p) => p[1])];
    const [left, right, bottom, top] = [Math.min(...us), Math.max(...us), Math.min(...vs), Math.max(...vs)];
    this.centre = [(left + right) / 2, (bottom + top) / 2];
    const room = (pixels, span) => (span > 0 ? Math.max(20, pixels - 2 * margin) / span : Infinity);
    const scale = Math.min(room(this.width, right - left), room(this.height, top - bottom));
    this.scale = Number.isFinite(scale) ? scale : 10;
  }
}
