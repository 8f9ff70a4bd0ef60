// The status page: shows the newest status, and stops the machine.  In: messages of the socket.  Out: the page; STOP.
"use strict";

const STALE = 300; // ms without a status until the page says so
const SEEN_EVERY = 4; // statuses between two words to the server that they have arrived
const at = (id) => document.getElementById(id);
let socket = null;
let session = null;
let status = null;
let arrived = 0;
let unsaid = 0;
let drawing = false;
let retry = 250;

async function ask(method, path, body) {
  const options = { method, headers: {}, credentials: "same-origin" };
  if (body !== undefined) {
    options.headers["content-type"] = "application/json";
    options.body = JSON.stringify(body);
  }
  const response = await fetch(path, options);
  const text = await response.text();
  return { ok: response.ok, code: response.status, data: text ? JSON.parse(text) : {} };
}

function show(what) {
  at("login").hidden = what !== "login";
  at("console").hidden = what !== "console";
  if (what === "login") at("user").focus();
}

async function begin() {
  try {
    const found = await ask("GET", "/api/session");
    if (!found.ok) {
      show("login");
      return;
    }
    session = found.data;
  } catch {
    setTimeout(begin, 1000);
    return;
  }
  show("console");
  connect();
}

function connect() {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  socket = new WebSocket(`${scheme}://${location.host}/api/socket`);
  socket.onmessage = (event) => {
    if (typeof event.data === "string") take(JSON.parse(event.data));
  };
  socket.onopen = () => {
    retry = 250;
  };
  socket.onclose = () => {
    socket = null;
    draw();
    setTimeout(begin, retry);
    retry = Math.min(retry * 2, 4000);
  };
}

function take(told) {
  if (told.session) session = told.session;
  if (told.ack && !told.ack.ok) at("fresh").textContent = told.ack.reason;
  if (told.status) {
    status = told.status;
    arrived = performance.now();
    unsaid += 1;
    if (unsaid >= SEEN_EVERY && socket) {
      socket.send(JSON.stringify({ kind: "seen", sequence: status.sequence }));
      unsaid = 0;
    }
  }
  if (!drawing) {
    drawing = true;
    requestAnimationFrame(draw);
  }
}

async function stop() {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ kind: "estop" }));
  // the same by another way: whichever arrives first stops the machine, the other changes nothing
  const answer = await ask("POST", "/api/stop").catch(() => null);
  if (answer && answer.code === 401) show("login");
}

const number = (value, digits) => value.toFixed(digits);
const seconds = (value) => (value < 90 ? `${value.toFixed(1)} s` : `${Math.floor(value / 60)} min ${Math.round(value % 60)} s`);

function fill(parent, rows, make) {
  while (parent.children.length > rows.length) parent.lastChild.remove();
  rows.forEach((row, i) => {
    if (!parent.children[i]) parent.append(make());
    row(parent.children[i]);
  });
}

function element(tag, parts = [], name = "") {
  const made = document.createElement(tag);
  made.className = name;
  made.append(...parts);
  return made;
}

function set(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

function axisRow(axis) {
  return (row) => {
    const [name, work, machine, speed, home] = row.children;
    set(name.children[0], axis.name);
    set(name.children[1], axis.unit);
    set(work, number(axis.work, 3));
    set(machine, number(axis.commanded, 3));
    set(speed, number(axis.velocity ?? 0, 1));
    set(home, axis.trusted ? "yes" : "no");
    home.className = axis.trusted ? "known" : "lost";
  };
}

function newAxisRow() {
  const head = element("th", [element("span"), element("span", [], "unit")]);
  head.scope = "row";
  return element("tr", [head, element("td", [], "work"), element("td"), element("td", [], "speed"), element("td")]);
}

function fact(name, value) {
  return (node) => {
    set(node.children[0], name);
    set(node.children[1], value);
  };
}

function facts() {
  const program = status.program;
  const percent = (value) => `${Math.round(value * 100)} %`;
  const found = [];
  if (program) {
    found.push(program.time_s ? fact("Line", `${program.line ?? 0} of ${program.lines}`) : fact("Lines", `${program.lines}`));
    if (program.time_s) found.push(fact("Time left", seconds(program.remaining_s ?? 0)));
  }
  found.push(fact("Path speed", `${number(status.speed, 1)} mm/s`));
  found.push(fact("Feed, rapid", `${percent(status.overrides.feed)}, ${percent(status.overrides.rapid)}`));
  found.push(fact("Spindle", `${Math.round(status.spindle)} rpm`));
  found.push(fact("Beam", status.beam > 0 ? "on" : status.armed ? "armed, off" : "off"));
  return found;
}

function draw() {
  drawing = false;
  if (!status) return;
  const stale = !socket || performance.now() - arrived > STALE;
  document.body.classList.toggle("stale", stale);
  set(at("machine"), status.machine);
  set(at("mover"), status.backend === "twin" ? "digital twin" : status.backend);
  set(at("state"), status.state === "estop" ? "Emergency stop" : status.state);
  document.title = `${status.state} – ${status.machine}`;
  set(at("fresh"), stale ? "no news from the machine: what is shown is old" : "");
  at("fresh").className = stale ? "bad" : "quiet";
  fill(document.querySelector("#axes tbody"), status.axes.map(axisRow), newAxisRow);
  const program = status.program;
  set(at("program"), program ? program.name : "none loaded");
  at("progress").hidden = !(program && program.time_s);
  if (program && program.time_s) at("progress").value = (program.done_s ?? 0) / program.time_s;
  fill(at("facts"), facts(), () => element("div", [element("dt"), element("dd")]));
  const alarms = status.alarms.map((alarm) => (node) => {
    set(node.children[0], alarm.message);
    set(node.children[1], alarm.remedy);
  });
  fill(at("alarms"), alarms, () => element("div", [element("p"), element("p")]));
  at("alarms").hidden = !alarms.length;
  at("message").hidden = !status.message;
  set(at("message"), status.message ?? "");
  at("request").hidden = !status.request;
  set(at("request"), status.request ? status.request.text : "");
  if (session) {
    const other = session.holder === session.user ? "in control from another place" : `${session.holder} has control`;
    const control = session.control ? "in control" : session.holder ? other : "nobody has control";
    const role = session.user === session.role ? "" : ` (${session.role})`;
    set(at("who"), `${session.user}${role}, ${control}`);
  }
}

at("stop").addEventListener("click", stop);
at("logout").addEventListener("click", async () => {
  await ask("POST", "/api/logout").catch(() => null);
  location.reload();
});
at("login-form").addEventListener("submit", async (event) => {
  event.preventDefault();
  set(at("login-error"), "");
  try {
    const answer = await ask("POST", "/api/login", { user: at("user").value, password: at("password").value });
    if (answer.ok) {
      at("password").value = "";
      begin();
    } else {
      set(at("login-error"), answer.data.error);
    }
  } catch {
    set(at("login-error"), "the server does not answer");
  }
});
setInterval(draw, STALE / 2);
begin();
