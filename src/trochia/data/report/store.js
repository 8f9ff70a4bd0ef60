// What the reader is looking at: one state, told to everyone who draws.

/**
 * @typedef {object} State
 * @property {number|null} time     the instant under the cursor [s]
 * @property {[number, number]} window  the times the plots show [s]
 * @property {number|null} line     the chosen source line
 * @property {string} feed          "mm/s" or "mm/min"
 * @property {Set<number>} hidden   axes left out of the plots
 */

class Store {
  /** @param {State} state */
  constructor(state) {
    this.state = state;
    /** @type {Array<(state: State, changed: Set<string>) => void>} */
    this.listeners = [];
  }

  /**
   * Change some of the state; listeners are told which keys changed, if any did.
   * @param {Partial<State>} patch
   */
  set(patch) {
    const changed = new Set(Object.keys(patch).filter((key) => patch[key] !== this.state[key]));
    if (!changed.size) return;
    this.state = { ...this.state, ...patch };
    for (const listener of this.listeners) listener(this.state, changed);
  }

  /** @param {(state: State, changed: Set<string>) => void} listener */
  subscribe(listener) {
    this.listeners.push(listener);
  }
}

/**
 * Run a drawing at most once per frame of the screen.
 * @param {() => void} draw
 * @returns {() => void} asks for it
 */
function oncePerFrame(draw) {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      draw();
    });
  };
}
