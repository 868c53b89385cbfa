// Frames as they come from the server, and their drawing.

function readFrames(buffer) {
  const view = new DataView(buffer);
  let at = 0;
  const count = () => { at += 4; return view.getUint32(at - 4, true); };
  const first = count(), many = count();
  for (let f = 0; f < many; ++f) {
    const points = new Map();
    for (let left = count(); left > 0; --left) {
      const id = count(), nodes = count(), list = new Float32Array(3 * nodes);
      for (let i = 0; i < list.length; ++i, at += 4) list[i] = view.getFloat32(at, true);
      points.set(id, list);
    }
    if (first + f < next) continue;
    if (!frames.length) state.time = first + f;
    frames.push({ number: first + f, points });
    next = first + f + 1;
  }
  return many;
}

// How figures hang together, of characters that are new.
async function readFigures() {
  const answer = await (await ask("GET", "/characters")).json();
  for (const { id, figure } of answer.characters) {
    const person = people.get(id);
    if (!person || !figure) continue;
    const points = frames.length && frames[frames.length - 1].points.get(id);
    if (!points || points.length !== 3 * figure.parents.length) continue;
    person.figure = { ...figure, bones: bonesOf(figure, points) };
  }
}

// How many frames are made ahead of those that are shown; what changes is late by them. One is needed to move
// towards, the others bridge the time that answers take.
let slowest = 0;  // seconds that an answer took, of the last ones
const ahead = () => 1 + Math.ceil(state.model.rate * Math.min(0.5, 0.02 + 1.5 * slowest));

async function fetchFrames() {
  const last = frames.length ? frames[frames.length - 1].number : state.time;
  const missing = Math.max(state.hurry ? 1 : 0, Math.ceil(ahead() - (last - state.time)));
  if (state.asking || !state.playing || people.size === 0 || missing < 1 && frames.length) return;
  state.asking = true;
  state.hurry = false;
  const most = Math.max(2, Math.ceil(state.model.rate)), asked = performance.now();
  try {
    // The first one alone: it is there sooner.
    const count = frames.length ? Math.min(missing, most) : 1;
    readFrames(await (await ask("GET", `/frames?from=${next}&count=${count}`)).arrayBuffer());
    slowest = Math.max((performance.now() - asked) / 1000, 0.95 * slowest);
    const newest = frames.length ? frames[frames.length - 1].points : new Map();
    for (const [id, points] of newest) {
      const person = people.get(id);
      if (person && (!person.figure || person.figure.parents.length * 3 !== points.length)) {
        await readFigures();
        break;
      }
    }
    let low = Infinity;
    for (const points of newest.values()) {
      for (let i = 1; i < points.length; i += 3) low = Math.min(low, points[i]);
      lows.push(low);
      low = Infinity;
    }
    if (lows.length > 400) lows.splice(0, lows.length - 400);
    if (lows.length) state.floor = [...lows].sort((a, b) => a - b)[Math.floor(lows.length / 20)];
  } catch (error) {
    if (error.status === 404) await attempt(restart);
    else { pause(true); say(error.message, true); }
  } finally {
    state.asking = false;
  }
}

// The places of a character's nodes at the time, between two frames; null if it is not there. A new one stands
// in its first frame until the others are there too.
function pose(id) {
  let before = null, after = null;
  for (const frame of frames) {
    if (frame.number <= state.time && frame.points.has(id)) before = frame;
    if (frame.number > state.time && frame.points.has(id)) { after = frame; break; }
  }
  if (!before) return after && after.points.get(id);
  const a = before.points.get(id);
  if (!after || after.number !== before.number + 1) return a;
  const b = after.points.get(id), part = state.time - before.number;
  return a.length === b.length ? a.map((v, i) => v + part * (b[i] - v)) : a;
}

// ---- drawing

function camera(width, tall) {
  const height = heightOf(), tilt = state.elevation * Math.PI / 180;
  const middle = [state.centre[0], state.floor + 0.45 * height, state.centre[1]];
  const view = cameraOf(middle, state.azimuth * Math.PI / 180, tilt, 7 * height / Math.min(1, state.zoom), width, tall);
  view.scale = state.zoom * Math.min(width / (4.2 * height), tall / (2.2 * height));
  return view;
}

// The place on the floor that is seen at a point of the canvas; null above the horizon.
function onFloor(view, px, py) {
  const a = (px - view.width / 2) / view.scale, b = (view.tall / 2 - py) / view.scale;
  const below = view.se - b * view.ce / view.away, depth = (state.floor - view.middle[1] - b * view.ce) / below;
  if (below < 0.02 || depth > 0.8 * view.away) return null;
  const part = (view.away - depth) / view.away, side = a * part;
  const front = depth * view.ce - b * part * view.se;
  return [view.middle[0] + side * view.ct - front * view.st, view.middle[2] + side * view.st + front * view.ct];
}

function draw() {
  const canvas = byId("canvas"), dark = isDark(), c = penOf(canvas, dark);
  if (!c) return;
  const height = heightOf(), shown = [];
  for (const person of people.values()) {
    person.spots = null;
    const now = pose(person.id);
    if (!now || !person.figure || now.length !== 3 * person.figure.parents.length) continue;
    person.last = now;
    shown.push({ person, now });
  }
  if (byId("follow").checked && shown.length) {
    const of = shown.filter(s => s.person.id === state.selected), all = of.length ? of : shown;
    for (const [k, axis] of [[0, 0], [1, 2]]) {
      const mean = all.reduce((sum, s) => sum + s.now[axis], 0) / all.length;
      state.centre[k] += (state.drawn ? 0.06 : 1) * (mean - state.centre[k]);
    }
  }
  const view = camera(canvas.clientWidth, canvas.clientHeight);
  if (byId("floor").checked) {
    const wider = Math.max(0, Math.ceil(Math.log2(1 / state.zoom)));
    drawFloor(c, view, state.floor, 0.3 * height * 2 ** wider, 4 * height / Math.min(1, state.zoom), dark);
    for (const { person, now } of shown) drawShadow(c, view, person.figure, now, state.floor, dark);
  }
  for (const s of shown) s.depth = view.turned(s.now[0], s.now[1], s.now[2])[2];
  shown.sort((a, b) => a.depth - b.depth);
  for (const { person, now } of shown) {
    if (person.id === state.selected) {
      c.beginPath();
      for (let i = 0; i <= 32; ++i)
        c.lineTo(...view.project(now[0] + 0.24 * height * Math.cos(i * Math.PI / 16), state.floor,
                                 now[2] + 0.24 * height * Math.sin(i * Math.PI / 16)).slice(0, 2));
      c.strokeStyle = getComputedStyle(document.body).getPropertyValue("--accent");
      c.lineWidth = 2;
      c.stroke();
    }
    person.spots = drawBody(c, view, person.figure, now, person.hue, 68, dark);
  }
  if (shown.length) ++state.drawn;
  const body = document.body.dataset;  // for those who watch the page from outside
  body.drawn = state.drawn;
  body.shown = shown.length;
  const busy = frames.length ? frames[frames.length - 1].number - state.time : 0;
  byId("clock").textContent = `${people.size} of at most ${state.model.characters} characters, ` +
      `${(state.time / state.model.rate).toFixed(1)} s` + (state.playing && people.size && busy <= 0 ? ", waiting" : "");
}

let before = performance.now();
function tick(now) {
  const passed = Math.min(Math.max(now - before, 0) / 1000, 0.25);
  before = now;
  if (state.model) {
    if (state.playing && frames.length && people.size) {
      state.time = Math.min(state.time + passed * state.model.rate, frames[frames.length - 1].number);
      while (frames.length > 2 && frames[1].number <= state.time) frames.shift();
      state.dirty = true;
    }
    fetchFrames();
    if (state.dirty) { state.dirty = false; draw(); }
  }
  requestAnimationFrame(tick);
}
