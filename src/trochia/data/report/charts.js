// The plots of a motion: which quantities there are, each axis in its colour.  A new plot is a new row of `chartSpecs`.

/** Quantities per axis: key of the channel, title, what follows the unit, decimals, key of the axis' limit. */
const AXIS_QUANTITIES = [
  ["position", "Position", "", 3, null],
  ["velocity", "Velocity", "/s", 2, "velocity"],
  ["acceleration", "Acceleration", "/s²", 0, "acceleration"],
];

/** Errors below this are told in micrometres [mm]. */
const SMALL_ERROR = 0.1;

/** Load angle at which a stepper gives its most, and beyond which it falls out of step [electrical degree]. */
const MOST_LOAD_ANGLE = 90;

/** @param {ChartSpec} spec @returns {ChartSpec} in µm, if it is in mm and its values are small */
function inMicrometres(spec) {
  const peak = spec.series.reduce((most, { values }) => values.reduce((a, b) => Math.max(a, Math.abs(b)), most), 0);
  if (spec.unit !== "mm" || peak >= SMALL_ERROR) return spec;
  const series = spec.series.map((one) => ({ ...one, values: one.values.map((value) => 1000 * value) }));
  return { ...spec, unit: "µm", digits: 2, series };
}

/**
 * @param {Motion} motion
 * @returns {ChartSpec[]} linear and rotary axes apart, since their units differ
 */
function chartSpecs(motion) {
  const { channels, axes, caps } = motion;
  const units = [...new Set(axes.map((axis) => axis.unit))];
  const perAxis = ([key, title, tail, digits, limit]) =>
    units.map((unit) => ({
      title, digits, unit: unit + tail, oneSided: false, mapped: false,
      series: axes
        .map((axis, i) => ({ name: axis.name, axis: i, values: channels[key][i], limit: limit && axis[limit], unit: axis.unit }))
        .filter((series) => series.unit === unit),
    }));
  const single = (title, unit, digits, values, limit, mapped) => ({
    title, digits, unit, oneSided: true, mapped, series: [{ name: "", axis: -1, values, limit }],
  });
  const specs = [single("Path speed", "mm/s", 2, channels.speed, caps.velocity, true)];
  specs.push(...AXIS_QUANTITIES.flatMap(perAxis));
  if (channels.following) specs.push(...perAxis(["following", "Following error", "", 4, null]).map(inMicrometres));
  if (channels.contour) specs.push(inMicrometres(single("Contour error", "mm", 4, channels.contour, null, false)));
  if (channels.load) {
    const series = channels.load.map((joint) => ({ ...joint, limit: MOST_LOAD_ANGLE }));
    specs.push({ title: "Load angle of the motors", unit: "° el.", digits: 1, oneSided: false, mapped: false, series });
  }
  if (channels.current) {
    const series = channels.current.map((joint) => ({ ...joint, limit: null }));
    specs.push({ title: "Current of the motors", unit: "A", digits: 3, oneSided: false, mapped: false, series });
  }
  return specs;
}

/**
 * Draw all plots under `parent` and keep them in step with the store.
 * @param {HTMLElement} parent
 * @param {Motion} motion
 * @param {Store} store
 * @returns {Chart[]}
 */
function attachCharts(parent, motion, store) {
  Chart.theme = new Theme();
  const charts = chartSpecs(motion).map((spec) => new Chart(parent, spec, motion, store));
  for (const chart of charts) {
    attachChartInput(chart, motion, store);
    attachChartKeys(chart.canvas, motion, store);
  }
  store.subscribe((_, changed) => {
    const redraw = ["window", "line", "feed", "hidden"].some((key) => changed.has(key));
    for (const chart of charts) {
      chart.root.hidden = chart.visible.length === 0;
      if (redraw) chart.draw();
      else chart.showCursor();
    }
  });
  return charts;
}
