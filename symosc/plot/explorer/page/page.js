// The page asks the server with its link, and draws the answer. One question is on its way at a time; the last move
// counts, so that a dragged slider is followed as fast as answers come.
"use strict";

const $ = id => document.getElementById(id);
const fields = new Map([...document.querySelectorAll(".field")].map(row => [row.dataset.name, {
  row, text: row.querySelector("[type=text]"), slider: row.querySelector("[type=range]"),
  error: row.querySelector(".error"),
}]));
const STARTS = ["t0", "x0", "v0"];
const SYMBOLS = {stick: "● onset of a stick", slip: "■ end of a stick", cross: "▲ crossing", graze: "★ graze"};
let waiting = false, asked = false, linkTimer = 0, settledTimer = 0, pastTimer = 0;
const past = [];  // links of the states before, the last one that of the page as it is

// --- the state: texts, sliders and the link ---

function link() {
  const state = new URLSearchParams();
  state.set("scene", $("scene-name").value);
  for (const [name, {text}] of fields) state.set(name, text.value.trim());
  if ($("start_error").value) state.set("start_error", $("start_error").value);
  return state.toString();
}

function numberOf(text) {
  const [above, below] = text.split("/").map(Number);
  return below === undefined ? above : above / below;
}

// Put a slider where its number is; a number beyond its ends moves them.
function follow({text, slider}) {
  const value = numberOf(text.value);
  if (!text.value.trim() || !Number.isFinite(value)) return;
  if (value < Number(slider.min)) slider.min = value;
  if (value > Number(slider.max)) slider.max = value;
  slider.value = value;
}

function take(state) {
  $("file").textContent = "";
  $("scene-name").value = state.scene ?? "";
  $("start_error").value = state.start_error ?? "";
  for (const [name, field] of fields) {
    field.text.value = state[name];
    follow(field);
  }
  ask();
}

// A start that was changed is exact.
function exact(name) {
  const errors = $("start_error").value.split(",");
  if (!STARTS.includes(name) || errors.length < 3) return;
  errors[STARTS.indexOf(name)] = "0";
  $("start_error").value = errors.join(",");
}

// --- question and answer ---

// Ask for the motion of the fields, or of the page's own link, which may say more than the fields hold.
async function ask(given = "") {
  if (waiting) { asked = true; return; }
  waiting = true;
  do {
    const again = asked;
    asked = false;
    const question = again || !given ? link() : given;
    try {
      show(await (await fetch(`answer?${question}`)).json());
      keepLink(link());
      remember(link());
      askSettled(link());
    } catch (error) {
      complain(`No answer: does symosc explore still run? (${error.message})`);
    }
  } while (asked);
  waiting = false;
}

// Browsers allow some hundred changes of the address in ten seconds.
function keepLink(question) {
  clearTimeout(linkTimer);
  linkTimer = setTimeout(() => history.replaceState(null, "", `?${question}`), 120);
  $("download").href = `scene.toml?${question}`;
}

// A state that lasts half a second can be come back to.
function remember(question) {
  clearTimeout(pastTimer);
  pastTimer = setTimeout(() => {
    if (past.at(-1) !== question) past.push(question);
    $("undo").disabled = past.length < 2;
  }, past.length ? 500 : 0);
}

// The orbit takes longer than the motion: it is asked for when nothing moves.
function askSettled(question) {
  clearTimeout(settledTimer);
  settledTimer = setTimeout(async () => {
    const answer = await (await fetch(`settled?${question}`)).json();
    if (question !== link()) return;
    $("settled").textContent = answer.text;
    plots.sources.settled.data = answer.curve;
  }, 250);
}

function complain(message) {
  $("status").textContent = message;
  $("status").classList.add("wrong");
  document.body.classList.add("stale");
}

function show(answer) {
  for (const [name, {row, text, error}] of fields) {
    const wrong = answer.errors[name] ?? "";
    if (error.textContent !== wrong) error.textContent = wrong;
    row.classList.toggle("wrong", Boolean(wrong));
    text.setAttribute("aria-invalid", Boolean(wrong));
  }
  $("notes").replaceChildren(...answer.notes.map(note => element("li", note)));
  const wrong = Object.entries(answer.errors);
  $("download").setAttribute("aria-disabled", wrong.length > 0);
  if (wrong.length) {
    const rest = wrong.filter(([name]) => !fields.has(name)).map(([name, said]) => `${name} ${said}`.trim());
    const where = rest.length < wrong.length ? ["See the numbers marked ⚠"] : [];
    const shown = $("name").textContent ? "The plots still show the previous motion." : "There is no motion to show yet.";
    complain([...rest, ...where, shown].join(". "));
    return;
  }
  document.body.classList.remove("stale");
  $("name").textContent = answer.name;
  const [other, ...shipped] = $("scene").options, chosen = shipped.find(each => each.text === answer.name) ?? other;
  other.text = chosen === other ? answer.name : "choose …";
  $("scene").value = chosen.value;
  document.title = `${answer.name}: symosc explore`;
  $("status").textContent = `${answer.message}; ${answer.count} event${answer.count === 1 ? "" : "s"}`;
  $("status").classList.toggle("wrong", answer.status === "undecidable");
  const word = answer.word.length ? answer.word.map(map => element("span", map)) : ["none: no belt is reached twice"];
  $("word").replaceChildren(...word);
  draw(answer);
  fill($("events"), answer.table.map(([kind, ...rest], i) => [i + 1, SYMBOLS[kind], ...rest]));
  const more = answer.count - answer.table.length;
  $("count").textContent = more > 0 ? `(the first ${answer.table.length} of ${answer.count})` : "";
  fill($("windows"), answer.windows);
}

function element(tag, text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}

function fill(table, rows) {
  const made = rows.map(row => {
    const line = document.createElement("tr");
    line.append(...row.map(cell => element("td", cell)));
    return line;
  });
  table.tBodies[0].replaceChildren(...made);
}

// --- the plots ---

const plots = {};

function draw(answer) {
  for (const [name, {start, end}] of Object.entries(plots.ranges)) {
    const range = plots.ranges[name], [low, high] = answer.ranges[name];
    const untouched = start === range.reset_start && end === range.reset_end;  // else somebody looks closer
    range.setv({reset_start: low, reset_end: high, ...(untouched ? {start: low, end: high} : {})});
  }
  const {speeds, drawn, names} = answer.belts;
  plots.belts.forEach((lines, i) => lines.forEach(line => line.setv({location: speeds[i], visible: drawn[i]})));
  if (JSON.stringify(names) !== plots.named) {  // laying out anew takes its time
    plots.named = JSON.stringify(names);
    for (const axis of plots.names) {
      axis.major_label_overrides = new Map(names);
      axis.ticker.ticks = names.map(([place]) => place);
    }
  }
  plots.drawing = true;
  for (const [name, columns] of Object.entries(answer.sources)) plots.sources[name].data = columns;
  plots.drawing = false;
}

// The start was dragged to another place of the phase plane.
function dragged() {
  const {x, v} = plots.sources.start.data;
  if (plots.drawing) return;
  for (const [name, value] of [["x0", x[0]], ["v0", v[0]]]) {
    const field = fields.get(name), text = String(Number(value.toPrecision(5)));
    if (Number(value) === numberOf(field.text.value) || text === field.text.value) continue;
    field.text.value = text;
    follow(field);
    exact(name);
  }
  ask();
}

// Follow the motion in eight seconds.
const PLAYED = 8000;
let playing = 0;

function play(begin) {
  const {t, x, v} = plots.sources.curves.data, part = (performance.now() - begin) / PLAYED;
  if (!playing || part > 1) {
    playing = 0;
    $("play").textContent = "Play";
    $("play").setAttribute("aria-pressed", "false");
    plots.sources.now.data = {t: [], x: [], v: []};
    return;
  }
  const time = t[0] + part * (t.at(-1) - t[0]);
  let low = 0, high = t.length - 1;
  while (high - low > 1) { const middle = (low + high) >> 1; if (t[middle] <= time) low = middle; else high = middle; }
  const between = (time - t[low]) / (t[high] - t[low] || 1), at = of => of[low] + between * (of[high] - of[low]);
  plots.sources.now.data = {t: [time], x: [at(x)], v: [at(v)]};
  playing = requestAnimationFrame(() => play(begin));
}

function ready() {
  const bokeh = Bokeh.documents[0], model = name => bokeh.get_model_by_name(name);
  plots.ranges = Object.fromEntries(["t", "x", "v", "F"].map(name => [name, model(`range-${name}`)]));
  const models = [...bokeh._all_models.values()], tagged = tag => models.filter(each => each.tags?.includes(tag));
  const sources = models.filter(each => each.type === "ColumnDataSource" && each.name);
  plots.sources = Object.fromEntries(sources.map(source => [source.name, source]));
  plots.belts = [1, 2].map(belt => tagged(`belt-${belt}`));
  plots.names = tagged("belt-names");
  const [drag] = tagged("drag-start"), plane = model("plane");
  if (matchMedia("(pointer: fine)").matches) plane.toolbar.active_drag = drag;  // a finger scrolls the page
  plots.sources.start.connect(plots.sources.start.change, dragged);
  for (const range of Object.values(plots.ranges)) range.setv({reset_start: range.start, reset_end: range.end});
  for (const field of fields.values()) follow(field);
  ask(location.search.slice(1));
}

(function wait() {
  if (Bokeh.documents.length && Bokeh.documents[0].is_idle) ready();
  else setTimeout(wait, 20);
})();

// --- what the reader does ---

for (const [name, field] of fields) {
  field.slider.addEventListener("input", () => {
    field.text.value = String(Number(field.slider.value));
    exact(name);
    ask();
  });
  field.text.addEventListener("input", () => {
    follow(field);
    exact(name);
    ask();
  });
}
$("inputs").addEventListener("submit", event => event.preventDefault());
$("scene").addEventListener("change", ({target}) => {
  if (target.value) take(Object.fromEntries(new URLSearchParams(target.value)));
});
$("undo").addEventListener("click", () => {
  if (past.length < 2) return;
  if (past.at(-1) === link()) past.pop();  // else what is shown is younger than the last one
  $("undo").disabled = past.length < 2;
  take(Object.fromEntries(new URLSearchParams(past.at(-1))));
});
$("reset").addEventListener("click", () => {
  const base = $("scene-name").value.replace(/, changed$/, "");
  const shipped = [...$("scene").options].find(each => each.value && each.text === base);
  take(Object.fromEntries(new URLSearchParams(shipped ? shipped.value : past[0])));
});
$("play").addEventListener("click", ({target}) => {
  if (playing) { playing = 0; return; }
  playing = 1;
  target.textContent = "Stop";
  target.setAttribute("aria-pressed", "true");
  play(performance.now());
});
$("copy").addEventListener("click", async ({target}) => {
  await navigator.clipboard.writeText(new URL(`?${link()}`, location.href).href);
  target.textContent = "Copied";
  setTimeout(() => { target.textContent = "Copy link"; }, 1500);
});
$("upload").addEventListener("change", async ({target}) => {
  const [file] = target.files;
  target.value = "";
  if (!file) return;
  const answer = await (await fetch("scene", {method: "POST", body: file})).json();
  if (!answer.error) take(answer.state);
  const said = answer.error ? [answer.error] : answer.notes;
  $("file").textContent = said.map(each => `${file.name}: ${each}`).join(" ");
});
