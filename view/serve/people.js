// The server, and the characters that it moves: what the page knows of them, and their list.
const token = new URLSearchParams(location.search).get("token");
const state = { session: null, model: null, playing: true, time: 0, azimuth: 50, elevation: 24, zoom: 1,
                centre: [0, 0], floor: 0, drawn: 0, selected: null, dirty: true, asking: false,
                hurry: false };  // hurry: someone waits for the next frame
const people = new Map();  // id -> { id, prompt, hue, figure, spots, last }
const frames = [];         // { number, points: Map(id -> Float32Array [nodes, 3]) }, those around state.time
let next = 0;              // number of the frame to ask for
const lows = [];           // lowest points of figures, for the height of the floor

const isDark = () => (document.documentElement.dataset.theme ||
    (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";

async function ask(method, path, body) {
  const query = new URLSearchParams();
  if (token) query.set("token", token);
  if (state.session) query.set("session", state.session);
  const options = { method, headers: {} };
  if (body !== undefined) {
    options.body = JSON.stringify(body);
    options.headers["Content-Type"] = "application/json";
  }
  let answer;
  try {
    answer = await fetch(path + (path.includes("?") ? "&" : "?") + query, options);
  } catch {
    throw Object.assign(new Error("the server does not answer; is motiongan serve still running?"), { status: 0 });
  }
  if (!answer.ok) {
    const why = await answer.json().catch(() => ({}));
    throw Object.assign(new Error(why.error || `the server answers ${answer.status}`), { status: answer.status });
  }
  return answer;
}

function addressOf(id, kind) {
  const query = new URLSearchParams({ session: state.session });
  if (token) query.set("token", token);
  return `/characters/${id}.${kind}?${query}`;
}

function say(text, bad = false) {
  byId("notes").textContent = text;
  byId("notes").className = bad ? "bad" : "";
}

// Does what the user asked for; says what went wrong.
async function attempt(action) {
  try {
    return await action();
  } catch (error) {
    say(error.message, true);
    if (error.status === 404 && /no such session/.test(error.message)) await restart();
  }
}

async function start() {
  state.session = null;
  const opened = await (await ask("POST", "/sessions")).json();
  state.session = opened.session;
  state.model = opened.model;
  next = 0;
  frames.length = lows.length = 0;
  people.clear();
}

async function restart() {
  await start();
  state.selected = null;
  say("The server dropped the characters of this page, which had sent no request for " +
      `${state.model.idle_seconds} seconds.`, true);
  showList();
}

// ---- characters

const heightOf = () => state.model.height;

// A free place on a spiral of triangles around the middle.
function freePlace() {
  const apart = 0.9 * heightOf(), taken = [...people.values()].filter(p => p.last).map(p => [p.last[0], p.last[2]]);
  for (let i = 0; ; ++i) {
    const radius = apart * Math.sqrt(i), angle = 2.4 * i;
    const x = state.centre[0] + radius * Math.cos(angle), z = state.centre[1] + radius * Math.sin(angle);
    if (taken.every(([a, b]) => Math.hypot(x - a, z - b) > 0.8 * apart)) return [x, z];
  }
}

async function add(prompt, place, more = {}) {
  const [x, z] = place || freePlace();
  const added = await (await ask("POST", "/characters", { prompt, x, z, ...more })).json();
  if (!people.size) frames.length = 0;  // nothing moves: the first new frame is shown at once
  people.set(added.id, { id: added.id, prompt, hue: (205 + 137.5 * added.id) % 360, figure: null, spots: null,
                         last: [x, 0, z] });
  state.hurry = true;
  tell(prompt, added);
  showList();
  return added.id;
}

async function change(id, prompt) {
  const person = people.get(id);
  if (!person || person.prompt === prompt) return;
  try {
    const changed = await (await ask("PATCH", `/characters/${id}`, { prompt })).json();
    person.prompt = prompt;
    tell(prompt, changed);
  } finally {
    showList();
  }
}

async function remove(id) {
  people.delete(id);
  if (state.selected === id) state.selected = null;
  showList();
  await ask("DELETE", `/characters/${id}`);
}

// Words that the model never saw, with what is near.
function tell(prompt, answer) {
  const quoted = list => list.map(w => `"${w}"`).join(", ");
  say("");
  if (answer.remark) say(`The text ${answer.remark}.`);
  if (!answer.unknown.length) return;
  const nearest = answer.nearest.length ? answer.nearest : state.model.prompts.slice(0, 3);
  say(`The model never saw ${quoted(answer.unknown)}. ` + (!nearest.length ? "" : answer.nearest.length
      ? "The nearest texts that it knows: " : "Texts that it knows: "));
  for (const text of nearest) {
    const button = document.createElement("button");
    button.textContent = text;
    button.onclick = () => { box().value = text; box().focus(); };
    byId("notes").append(button);
  }
}

// A box for a text, with the model's descriptions, or a choice of classes.
function promptBox(value) {
  const box = document.createElement(state.model.classes ? "select" : "input");
  if (state.model.classes) {
    for (const name of state.model.prompts) box.append(new Option(name, name, false, name === value));
  } else {
    box.type = "text";
    box.maxLength = 500;
    box.placeholder = "describe a motion";
    box.setAttribute("list", "texts");
    box.value = value;
  }
  return box;
}
const box = () => byId("ask").firstElementChild;

function buttonOf(text, title, act) {
  const button = document.createElement("button");
  button.textContent = text;
  button.title = title;
  button.onclick = e => { e.stopPropagation(); act(); };
  return button;
}

function showList() {
  byId("hint").textContent = people.size ? "" : state.model.classes
      ? "Choose a class, then press Add or click here" : "Type a text, then press Add or click here";
  const rows = [...people.values()].map(person => {
    const row = document.createElement("div"), dot = document.createElement("i");
    row.className = "row";
    row.dataset.id = person.id;
    dot.style.background = `hsl(${person.hue},68%,50%)`;
    row.append(dot);
    if (person.id !== state.selected) {
      const text = document.createElement("span");
      text.textContent = person.prompt;
      row.append(text);
      row.onclick = () => select(person.id);
      return row;
    }
    row.className = "row selected";
    const text = promptBox(person.prompt), buttons = document.createElement("div");
    text.onchange = () => attempt(() => change(person.id, text.value));
    text.onkeydown = e => { if (e.key === "Enter") text.blur(); };
    const save = kind => { location.href = addressOf(person.id, kind); };
    const kept = `the last ${state.model.kept_seconds} seconds that were seen, as `;
    buttons.append(buttonOf("Remove", "Del", () => attempt(() => remove(person.id))),
                   buttonOf("BVH", kept + "BVH", () => save("bvh")),
                   buttonOf("GLB", kept + "GLB", () => save("glb")),
                   buttonOf("Deselect", "Esc", () => select(null)));
    row.append(text, buttons);
    return row;
  });
  byId("list").replaceChildren(...rows);
  state.dirty = true;
}

function select(id) {
  state.selected = id;
  showList();
  const row = byId("list").querySelector(".selected");
  if (row) row.scrollIntoView({ block: "nearest" });
}
