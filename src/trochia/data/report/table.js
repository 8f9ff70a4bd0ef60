// Lines of the program on the page: a click chooses one, which the path and the plots then mark.

/**
 * @param {Store} store
 * @param {Motion} motion
 */
function attachLines(store, motion) {
  const links = [...document.querySelectorAll(".line-link")];
  const rows = [...document.querySelectorAll("#slow tbody tr")];
  const choose = (line) => {
    const chosen = store.state.line === line ? null : line;
    const spans = chosen === null || !motion.moves ? [] : motion.spans(chosen);
    store.set(spans.length ? { line: chosen, time: spans[0][0] } : { line: chosen });
  };
  for (const link of links) {
    link.addEventListener("click", (event) => {
      event.stopPropagation();
      choose(Number(link.dataset.line));
    });
  }
  for (const row of rows) row.addEventListener("click", () => choose(Number(row.dataset.line)));
  store.subscribe(({ line }, changed) => {
    if (!changed.has("line")) return;
    for (const link of links) link.setAttribute("aria-pressed", String(Number(link.dataset.line) === line));
    for (const row of rows) row.classList.toggle("chosen", Number(row.dataset.line) === line);
  });
}

/**
 * Write the speeds of the page's tables in the reader's unit.
 * @param {string} unit
 */
function writeSpeeds(unit) {
  for (const cell of document.querySelectorAll("[data-speed]")) {
    cell.textContent = formatNumber(Number(cell.dataset.speed) * FEED_UNITS[unit], feedDigits(unit));
  }
  for (const cell of document.querySelectorAll("[data-speed-unit]")) cell.textContent = unit;
}
