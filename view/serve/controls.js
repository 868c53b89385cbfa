// What the user does, and how the page starts.

function pause(on) {
  state.playing = !on;
  byId("pause").textContent = on ? "Play" : "Pause";
  state.dirty = true;
}
function resetView() {
  Object.assign(state, { azimuth: 50, elevation: 24, zoom: 1, centre: [0, 0], dirty: true });
  byId("follow").checked = true;
}
function setTheme(name) { document.documentElement.dataset.theme = name; state.dirty = true; }
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);

// The character whose figure is nearest to a point of the canvas, if that is near.
function personAt(x, y) {
  let best = null, least = 14;
  for (const person of people.values()) {
    if (!person.spots) continue;
    for (const bone of person.figure.bones) {
      const a = person.spots[bone.from], b = person.spots[bone.to], dx = b[0] - a[0], dy = b[1] - a[1];
      const part = clamp(((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy || 1), 0, 1);
      const far = Math.hypot(x - a[0] - part * dx, y - a[1] - part * dy);
      if (far < least) [best, least] = [person.id, far];
    }
  }
  return best;
}

function clickAt(x, y) {
  const id = personAt(x, y), canvas = byId("canvas");
  if (id !== null) return select(id);
  const place = onFloor(camera(canvas.clientWidth, canvas.clientHeight), x, y);
  if (!place) return say("There is no floor; click lower, or drag the view down.");
  if (!box().value.trim()) return say("Type a text first."), box().focus();
  attempt(() => add(box().value, place));
}

function listen() {
  const canvas = byId("canvas"), touches = new Map();  // pointer id -> [x, y]
  let travelled = 0, moves = false;
  const apart = () => { const [a, b] = [...touches.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
  canvas.addEventListener("pointerdown", e => {
    if (!touches.size) travelled = 0;
    moves = e.shiftKey || e.button !== 0;
    touches.set(e.pointerId, [e.offsetX, e.offsetY]);
    canvas.setPointerCapture(e.pointerId);
  });
  canvas.addEventListener("pointermove", e => {
    if (!touches.has(e.pointerId)) return;
    const [x, y] = touches.get(e.pointerId), dx = e.offsetX - x, dy = e.offsetY - y;
    const wide = touches.size === 2 ? apart() : 0;
    touches.set(e.pointerId, [e.offsetX, e.offsetY]);
    travelled += Math.abs(dx) + Math.abs(dy) + (touches.size - 1) * 10;
    if (travelled < 5) return;
    if (touches.size === 2 && wide > 0) {
      state.zoom = clamp(state.zoom * apart() / wide, 0.1, 12);
    } else if (moves) {
      const view = camera(canvas.clientWidth, canvas.clientHeight);
      const from = onFloor(view, x, y), to = onFloor(view, e.offsetX, e.offsetY);
      byId("follow").checked = false;
      if (from && to) state.centre = [state.centre[0] + from[0] - to[0], state.centre[1] + from[1] - to[1]];
    } else {
      state.azimuth += 0.5 * dx;
      state.elevation = clamp(state.elevation + 0.4 * dy, 2, 89);
    }
    state.dirty = true;
  });
  const end = e => {
    if (touches.delete(e.pointerId) && e.type === "pointerup" && travelled < 5 && !touches.size && e.button === 0)
      clickAt(e.offsetX, e.offsetY);
  };
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("contextmenu", e => e.preventDefault());
  canvas.addEventListener("wheel", e => {
    e.preventDefault();
    state.zoom = clamp(state.zoom * Math.exp(-0.0015 * e.deltaY), 0.1, 12);
    state.dirty = true;
  }, { passive: false });

  byId("ask").onsubmit = e => {
    e.preventDefault();
    if (!box().value.trim()) return say("Type a text first.");
    attempt(() => add(box().value));
  };
  byId("pause").onclick = () => pause(state.playing);
  for (const id of ["follow", "floor"]) byId(id).onchange = () => state.dirty = true;
  byId("reset").onclick = resetView;
  byId("theme").onclick = () => setTheme(isDark() ? "light" : "dark");
  const keys = { " ": () => pause(state.playing), f: () => byId("follow").click(), g: () => byId("floor").click(),
    r: resetView, t: () => setTheme(isDark() ? "light" : "dark"), Escape: () => select(null),
    Delete: () => { if (state.selected !== null) attempt(() => remove(state.selected)); } };
  addEventListener("keydown", e => {
    const key = keys[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    if (!key || e.ctrlKey || e.metaKey || e.altKey || /^(INPUT|SELECT|BUTTON)$/.test(e.target.tagName)) return;
    e.preventDefault();
    key();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => state.dirty = true);
  new ResizeObserver(() => state.dirty = true).observe(canvas);
  // A paused page stays known to the server.
  setInterval(() => { if (state.session) attempt(() => ask("GET", "/characters")); }, 20000);
  addEventListener("pagehide", () => {
    const query = new URLSearchParams({ session: state.session });
    if (token) query.set("token", token);
    fetch("/session?" + query, { method: "DELETE", keepalive: true });
  });
}

// #prompt=walk opens with a character of that text or class, and may be repeated; also az, el (degrees), zoom,
// select (a number from 0), theme (dark or light).
async function readAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  const number = (name, use) => { if (given.has(name) && isFinite(given.get(name))) use(+given.get(name)); };
  number("az", a => state.azimuth = a);
  number("el", e => state.elevation = clamp(e, 2, 89));
  number("zoom", z => state.zoom = clamp(z, 0.1, 12));
  if (given.has("theme")) setTheme(given.get("theme") === "dark" ? "dark" : "light");
  for (const prompt of given.getAll("prompt")) await attempt(() => add(prompt));
  number("select", id => { if (people.has(id)) select(id); });
}

const ways = {
  frames: "",
  seconds: "This model makes a second at once: a change of the class shows after up to a second.",
  windows: "This model has no stream: it makes a window of frames at once. The next one, and a change of the text, " +
      "begin where the character is, with a jump of its pose."
};

async function open() {
  await start();
  document.title = `motiongan: ${state.model.name}`;
  byId("ask").prepend(promptBox(state.model.prompts[0] || ""));
  const texts = document.createElement("datalist");
  texts.id = "texts";
  if (!state.model.classes) texts.append(...state.model.prompts.map(text => new Option(text)));
  document.body.append(texts);
  byId("made").textContent = `${state.model.name}: ${+state.model.rate.toPrecision(4)} frames per second. ` +
      ways[state.model.made];
  listen();
  showList();
  requestAnimationFrame(tick);
  await readAddress();
}
open().catch(error => { byId("hint").textContent = error.message; });
