// What the path view is made of: each function draws one layer in CSS pixels.

/**
 * Stroke the segments i → i + 1 for which `wanted(i)` holds, joined where they follow each other.
 * @param {CanvasRenderingContext2D} context
 * @param {{x: Float32Array, y: Float32Array}} points
 * @param {(segment: number) => boolean} wanted
 */
function strokeRuns(context, { x, y }, wanted) {
  context.beginPath();
  let open = false;
  for (let i = 0; i + 1 < x.length; i++) {
    if (wanted(i)) {
      if (!open) context.moveTo(x[i], y[i]);
      context.lineTo(x[i + 1], y[i + 1]);
      open = true;
    } else {
      open = false;
    }
  }
  context.stroke();
}

/** Segments by colour, in runs that follow each other: computed once, stroked at every change of view. */
class ColourRuns {
  /**
   * @param {number} points
   * @param {number} levels how many colours there are
   * @param {(segment: number) => number} levelOf the colour of the segment i → i + 1, or -1 for none
   */
  constructor(points, levels, levelOf) {
    /** @type {number[][]} per level: first, last, first, last … points of runs */
    this.levels = Array.from({ length: levels }, () => []);
    let level = -1;
    for (let i = 0; i + 1 < points; i++) {
      const next = levelOf(i);
      if (next >= 0) {
        if (next === level) this.levels[next][this.levels[next].length - 1] = i + 1;
        else this.levels[next].push(i, i + 1);
      }
      level = next;
    }
  }

  /**
   * @param {CanvasRenderingContext2D} context
   * @param {{x: Float32Array, y: Float32Array}} points
   * @param {string[]} colours
   * @param {[number, number]} bounds first and last point to draw
   */
  stroke(context, { x, y }, colours, [first, last]) {
    this.levels.forEach((runs, level) => {
      if (!runs.length) return;
      context.strokeStyle = colours[level];
      context.beginPath();
      for (let r = 0; r < runs.length; r += 2) {
        const end = Math.min(runs[r + 1], last);
        let i = Math.max(runs[r], first);
        if (i >= end) continue;
        context.moveTo(x[i], y[i]);
        while (i < end) {
          i++;
          context.lineTo(x[i], y[i]);
        }
      }
      context.stroke();
    });
  }
}

/** The path by speed; rapids are drawn otherwise. */
function speedRuns({ path, topFeed }) {
  const { speed, rapid } = path;
  const level = (i) => (rapid[i + 1] ? -1 : speedLevel((speed[i] + speed[i + 1]) / 2, topFeed));
  return new ColourRuns(speed.length, LEVELS, level);
}

/** The path by the limit that binds, rapids too. */
function limitRuns({ path, limits }) {
  const groups = limits.map(({ group }) => LIMIT_GROUPS.indexOf(group));
  return new ColourRuns(path.limit.length, LIMIT_GROUPS.length, (i) => groups[path.limit[i + 1]]);
}

/** Millimetre paper under a plane view, numbered along two edges. */
function drawPaper(context, camera, theme, names) {
  const { width, height } = camera;
  const [left, right, bottom, top] = camera.window();
  const across = ticks(left, right, width / 90);
  const step = across.values.length > 1 ? across.values[1] - across.values[0] : right - left;
  const up = { values: [], digits: across.digits };
  for (let i = Math.ceil(bottom / step); i * step <= top; i++) up.values.push(i * step);
  const [ox, oy] = [width / 2 - camera.scale * camera.centre[0], height / 2 + camera.scale * camera.centre[1]];
  context.strokeStyle = theme.get("grid");
  context.lineWidth = 1;
  context.beginPath();
  for (const value of across.values) {
    const x = Math.round(ox + camera.scale * value) + 0.5;
    context.moveTo(x, 0);
    context.lineTo(x, height);
  }
  for (const value of up.values) {
    const y = Math.round(oy - camera.scale * value) + 0.5;
    context.moveTo(0, y);
    context.lineTo(width, y);
  }
  context.stroke();
  context.fillStyle = theme.get("soft");
  context.font = theme.font;
  context.textAlign = "center";
  context.textBaseline = "bottom";
  for (const value of across.values) {
    const x = ox + camera.scale * value;
    if (x > 48 && x < width - 36) context.fillText(formatFixed(value, across.digits), x, height - 4);
  }
  context.textAlign = "left";
  context.textBaseline = "middle";
  for (const value of up.values) {
    const y = oy - camera.scale * value;
    if (y > 28 && y < height - 24) context.fillText(formatFixed(value, up.digits), 6, y);
  }
  context.fillStyle = theme.get("soft");
  context.font = `600 ${theme.font}`;
  context.textAlign = "right";
  context.textBaseline = "bottom";
  context.fillText(names[0], width - 6, height - 4);
  context.textAlign = "left";
  context.textBaseline = "top";
  context.fillText(names[1], 6, 6);
}

/** The machine's travel: a rectangle, or twelve edges of a box. */
function drawTravel(context, camera, axes, theme) {
  const corners = boxCorners(camera.columns, axes.map((axis) => axis.travel), axes.length);
  context.strokeStyle = theme.get("travel");
  context.lineWidth = 1.25;
  context.setLineDash([]);
  context.beginPath();
  for (let a = 0; a < corners.length; a++) {
    for (let bit = 1; bit < corners.length; bit <<= 1) {
      if (a & bit) continue;
      context.moveTo(...camera.screen(corners[a]));
      context.lineTo(...camera.screen(corners[a | bit]));
    }
  }
  context.stroke();
}

/**
 * Corners of a box over some columns; corner number b has the upper end where bit i of b is set.
 * @param {number[]} columns
 * @param {Array<[number, number]>} ranges by column
 * @param {number} width columns of a point
 * @returns {number[][]}
 */
function boxCorners(columns, ranges, width) {
  return Array.from({ length: 1 << columns.length }, (_, corner) => {
    const point = new Array(width).fill(0);
    columns.forEach((column, i) => (point[column] = ranges[column][(corner >> i) & 1]));
    return point;
  });
}

/** Directions of the axes in the corner of a view all round. */
function drawTriad(context, camera, axes, theme) {
  const [x, y] = [38, camera.height - 38];
  context.font = `600 ${theme.font}`;
  context.lineWidth = 2;
  context.textAlign = "center";
  context.textBaseline = "middle";
  camera.columns.forEach((column, i) => {
    const [dx, dy] = [26 * camera.right[i], -26 * camera.up[i]];
    context.strokeStyle = context.fillStyle = theme.axis(column);
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x + dx, y + dy);
    context.stroke();
    context.fillText(axes[column].name, x + 1.35 * dx, y + 1.35 * dy);
  });
}

/** A ruler of a round length. */
function drawScaleBar(context, camera, theme) {
  const length = niceStep(Math.min(160, camera.width / 4) / camera.scale);
  const pixels = length * camera.scale;
  const [right, y] = [camera.width - 14, camera.height - 30];
  const text = length >= 1 ? `${formatNumber(length, 0)} mm` : `${formatNumber(length * 1000, 3)} µm`;
  context.font = theme.font;
  context.textAlign = "center";
  context.textBaseline = "bottom";
  context.lineJoin = "round";
  context.lineWidth = 4;
  context.strokeStyle = theme.get("paper");
  context.strokeText(text, right - pixels / 2, y - 5);
  context.fillStyle = theme.get("ink");
  context.fillText(text, right - pixels / 2, y - 5);
  for (const [width, colour] of [[5, theme.get("paper")], [1.5, theme.get("ink")]]) {
    context.lineWidth = width;
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(right - pixels, y - 4);
    context.lineTo(right - pixels, y);
    context.lineTo(right, y);
    context.lineTo(right, y - 4);
    context.stroke();
  }
}

/** A ring where motion starts and a square where it ends. */
function drawEnds(context, camera, first, last, theme) {
  const [sx, sy] = camera.screen(first);
  const [ex, ey] = camera.screen(last);
  context.lineWidth = 2;
  context.strokeStyle = theme.get("mark");
  context.fillStyle = theme.get("paper");
  context.beginPath();
  context.rect(ex - 4.5, ey - 4.5, 9, 9);
  context.fill();
  context.stroke();
  context.beginPath();
  context.arc(sx, sy, 5.5, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
  context.font = `600 ${theme.font}`;
  context.textBaseline = "bottom";
  const together = Math.hypot(sx - ex, sy - ey) < 14;
  const marks = together ? [["start, end", sx, sy]] : [["start", sx, sy], ["end", ex, ey]];
  for (const [text, x, y] of marks) {
    const rightward = x < camera.width - 80;
    context.textAlign = rightward ? "left" : "right";
    context.lineWidth = 4;
    context.strokeStyle = theme.get("paper");
    context.strokeText(text, x + (rightward ? 9 : -9), y - 6);
    context.fillStyle = theme.get("mark");
    context.fillText(text, x + (rightward ? 9 : -9), y - 6);
  }
}
