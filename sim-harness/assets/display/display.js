// What the page shows. In: updates of `/events`, which replace the points from `from` on and everything else. Nothing is sent back.
"use strict";

const $ = (id) => document.getElementById(id);
const NONE = "–";
const state = { points: [], previous: [], past: [], now: {}, link: null, missing: null, setup: { train: null, track: null }, described: null, scale: { least: 0.1, most: 0.1 }, gone: false };

const fixed = (value, digits, scale = 1) => (value == null || !Number.isFinite(value) ? NONE : (value * scale).toFixed(digits).replace("-", "−"));
/** Two-sided 95 % and 90 % of a normal distribution, in standard deviations. */
const NINETY_FIVE = 1.96, NINETY = 1.645;
/** What stands behind ± of an estimate: half of its 95 % interval. */
const half = (sd, digits, scale = 1) => "±" + fixed(sd, digits, NINETY_FIVE * scale);
const deviation = (sd, digits) => "s.d. " + fixed(sd, digits);
function put(id, text) {
  const element = $(id);
  if (element.textContent !== text) element.textContent = text;
}

// ---- now

const VALIDITY = { valid: "location and speed are valid", held: "held", invalid: "not valid" };

function validity(estimate) {
  if (!estimate) return ["none", "waiting for a run"];
  const of = estimate.validity;
  if (typeof of === "string") return [of, VALIDITY[of] ?? of];
  const [[word, cause]] = Object.entries(of);
  return [word, `${VALIDITY[word] ?? word}: ${cause.replaceAll("_", " ")}`];
}

function age(link) {
  return link.age_s == null ? "no frame yet" : `no frame for ${Math.round(link.age_s)} s`;
}

function showNow() {
  const { estimate } = state.now, link = state.link;
  const ended = link?.connection.state === "ended";
  const old = state.gone || !link || link.connection.state === "lost" || (link.silent && !ended);
  document.body.classList.toggle("old", old);
  put("speed", fixed(estimate?.speed_mps.value, 0, KMH));
  put("speed-sd", half(estimate?.speed_mps.sd, 1, KMH));
  put("location", fixed(estimate?.location_m.value, 2, 1e-3));
  put("location-sd", half(estimate?.location_m.sd, 0) + (estimate ? " m" : ""));
  const regime = $("regime");
  regime.dataset.regime = estimate?.regime ?? "none";
  regime.querySelector("b").textContent = estimate?.regime ?? "no run";
  let [word, text] = validity(estimate);
  if (state.gone) [word, text] = ["old", "the display program has ended"];
  else if (old && link) [word, text] = [link.age_s == null ? "none" : "old", link.age_s == null ? age(link) : `${age(link)}: these values are old`];
  else if (ended) [word, text] = ["ended", "end of the recording"];
  $("validity").dataset.state = word;
  put("validity", text);
  put("next-stop", nextStop(estimate));
  showCoasting();
}

/** Chainage grows or falls with the run. */
function direction() {
  const { points } = state;
  return points.length < 2 ? 0 : Math.sign(points.at(-1)[0] - points[0][0]);
}

function nextStop(estimate) {
  const stops = state.setup.track?.stop ?? [], way = direction();
  if (!estimate || !way) return "next stop –";
  const ahead = stops.map((stop) => [way * (stop.at_m - estimate.location_m.value), stop.name]).filter(([m]) => m > 0);
  if (!ahead.length) return "next stop –";
  const [m, name] = ahead.reduce((a, b) => (a[0] < b[0] ? a : b));
  return `${name} in ${fixed(m, 1, 1e-3)} km`;
}

// ---- coasting from here


function targetName(target) {
  const stop = (state.setup.track?.stop ?? []).find((stop) => Math.abs(stop.at_m - target.at_m) < 1);
  const place = `${fixed(target.at_m, 1, 1e-3)} km`;
  if (target.limit_mps != null) return `${fixed(target.limit_mps, 0, KMH)} km/h at ${place}`;
  return stop ? stop.name : `stop at ${place}`;
}

/** What stands large, what below it, and where to. An outcome is a word, or a word with values. */
function coasting(ahead, estimate) {
  if (!ahead || !estimate) return [NONE, "no prediction yet", ""];
  const [word, value] = typeof ahead.outcome === "string" ? [ahead.outcome] : Object.entries(ahead.outcome)[0];
  const to = ahead.target ? targetName(ahead.target) : "";
  if (word === "arrives") {
    const { speed_mps, time_s, time_sd_s } = value, s = Math.max(0, Math.round(time_s - estimate.time_s));
    return [`${fixed(speed_mps.value, 0, KMH)} ±${fixed(NINETY * speed_mps.sd, 0, KMH)}`,
      `in ${Math.floor(s / 60)}:${String(s % 60).padStart(2, "0")} ±${fixed(NINETY * time_sd_s, 0)} s (90 %)`, to];
  }
  if (word === "stops") return ["stops", `at ${fixed(value.value, 1, 1e-3)} ±${fixed(NINETY * value.sd, 1, 1e-3)} km (90 %)`, to];
  if (word === "may_stop") return ["may stop", "before it gets there", to];
  if (word === "no_target") return [NONE, "no target within the horizon", ""];
  return [NONE, "no prediction now", ""];
}

function showCoasting() {
  const [large, small, to] = coasting(state.now.coast_ahead, state.now.estimate);
  put("advice-speed", large);
  put("advice-unit", /\d/.test(large) ? "km/h" : "");
  put("advice-time", small);
  put("advice-to", to ? `to ${to}` : "from here");
}

/** Where the speed at the target is drawn, if the train gets there. */
function arrival() {
  const ahead = state.now.coast_ahead, to = ahead?.outcome?.arrives;
  if (!to || !ahead.target) return null;
  const of = (sd) => KMH * (to.speed_mps.value + sd * to.speed_mps.sd);
  return { km: ahead.target.at_m / 1000, kmh: of(0), low: of(-NINETY), high: of(NINETY) };
}

// ---- run

const run = {
  arrival,
  stops: () => state.setup.track?.stop ?? [],
  train: () => {
    const { estimate } = state.now;
    return estimate && { km: estimate.location_m.value / 1000, kmh: estimate.speed_mps.value * KMH, regime: REGIMES.indexOf(estimate.regime) };
  },
};

/** The track, or what has been seen in steps of 5 km, so that the scale rests; a location that is a little below its step is noise. */
function range() {
  const length = state.setup.track?.length_m;
  if (length) return [0, length / 1000];
  const km = [...state.points, ...state.previous].map((point) => point[0] / 1000);
  if (!km.length) return [0, 5];
  return [Math.floor(Math.min(...km) / 5 + 0.02) * 5, (Math.floor(Math.max(...km) / 5) + 1) * 5];
}

function showRun() {
  const { track } = state.setup, limits = track?.speed_limit ?? [];
  const most = Math.max(140, ...limits.map((limit) => limit.kmh), ...state.points.map((point) => point[1] * KMH));
  runChart.show(runData(state.points, state.previous, limits, track?.length_m), { x: range(), y: [0, Math.ceil((most + 5) / 20) * 20] });
  strips();
}

function block(from, to, [low, high], text) {
  const left = Math.max(0, (from / 1000 - low) / (high - low)), right = Math.min(1, (to / 1000 - low) / (high - low));
  const span = document.createElement("span");
  span.style.left = 100 * left + "%";
  span.style.width = 100 * Math.max(0, right - left) + "%";
  span.textContent = text;
  span.title = text;
  return span;
}

/** A value as short as it may be. */
const short = (value) => String(Number(value.toPrecision(3)));
const values = (effect) => effect.values.map((v) => `${v.label} ${short(v.value)}${v.unit ? " " + v.unit : ""}`).join(", ");
const plain = (name) => name.replaceAll("_", " ");
let drawn = "";

function strips() {
  const key = JSON.stringify([state.now.effects, range(), state.described]);
  if (key === drawn) return;
  drawn = key;
  const [low, high] = range(), track = state.setup.track, slopes = track?.gradient ?? [];
  $("gradients").dataset.missing = track ? "" : "limits, stops, gradients: start with --track K.toml";
  const steepest = Math.max(5, ...slopes.map((g) => Math.abs(g.permille)));
  $("gradients").replaceChildren(...slopes.map((g, i) => {
    const span = block(g.from_m, slopes[i + 1]?.from_m ?? track.length_m, [low, high], "");
    const height = (50 * Math.abs(g.permille)) / steepest;
    span.style.height = height + "%";
    span.style.top = (g.permille > 0 ? 50 - height : 50) + "%";
    span.title = `${g.permille} ‰`;
    return span;
  }));
  const effects = state.now.effects ?? [], local = effects.filter((e) => e.section_m);
  $("effects").replaceChildren(...local.map((e) => block(...e.section_m, [low, high], `${plain(e.name)} ${e.values.map((v) => short(v.value)).join(" ")}`)));
  const where = (e) => (e.section_m ? `${e.section_m.map((m) => short(m / 1000)).join("–")} km` : "everywhere");
  const words = effects.map((e) => `${plain(e.name)} ${where(e)}: ${values(e)}`);
  put("effect-words", `effects in the board's model: ${words.join("; ") || "none"}`);
}

// ---- resistance

const LEARNED = { not_yet: "not learned yet", learned: "learned", out_of_bounds: "out of bounds", predicts_worse: "predicts worse than the description" };

function showResistance() {
  const { parameters } = state.now, davis = state.setup.train?.davis;
  $("learned").dataset.state = parameters?.learned ?? "not_yet";
  put("learned", parameters ? LEARNED[parameters.learned] ?? parameters.learned : "not learned yet");
  const described = (value, digits) => (davis ? `maker ${fixed(value, digits, 1000)}` : "");
  const [r, sd] = parameters ? resistanceAt(parameters, 100 / KMH) : [];
  put("r100", fixed(r, 1, 1000));
  put("r100-sd", half(sd, 1, 1000));
  const maker = davis && describedAt(davis, 100 / KMH);
  put("r100-described", maker && r != null ? `${r >= maker ? "+" : ""}${fixed(100 * (r / maker - 1), 1)} ${half((100 * sd) / maker, 1)} %` : described(maker, 1));
  for (const [name, digits] of [["r0", 2], ["r1", 3], ["r2", 4]]) {
    put(name, fixed(parameters?.[name].value, digits, 1000));
    put(name + "-sd", half(parameters?.[name].sd, digits, 1000));
    put(name + "-described", described(davis?.[name], digits));
  }
  put("gain", fixed(parameters?.gain?.value, 3));
  put("gain-sd", half(parameters?.gain?.sd, 3));
  const data = resistanceData(parameters, davis);
  const most = Math.max(40, ...[2, 4].flatMap((i) => data[i]).filter((v) => v != null));
  resistanceChart.show(data, { x: [0, 160], y: [0, Math.ceil(most / 20) * 20] });
}

/** How much was learned, and how well coasts were foreseen. */
function showJudged() {
  const { learned_bits: bits, coasts } = state.now.judged ?? {};
  const late = state.now.parameters ? "not known: this display came later" : NONE;
  put("information", `information learned ${bits ? `at 20 / 60 / 100 / 140 km/h: ${bits.map((bit) => fixed(bit, 1)).join(" / ")} bit` : late}`);
  put("foreseen", `coasts foreseen ${coasts?.count ? `within their 90 % interval: ${coasts.within} of ${coasts.count}, error ${fixed(coasts.rms_mps, 1, KMH)} km/h` : NONE}`);
}

/** The sensor whose readings could not be used most often in this run. */
function suspected() {
  const { status, judged } = state.now;
  if (!judged?.suspected) return status && "none";
  const { sensor, count, causes } = judged.suspected;
  return `${sensor}: ${count} (${causes.map(([cause, times]) => `${plain(cause)} ${times}`).join(", ")})`;
}

// ---- several units

const LEAST_UNITS = 2, UNITS_MS = 2000;
let unitsChart = null;

function showUnits(units) {
  if (!unitsChart) unitsChart = new Chart($("units-chart"), unitsOptions(units.length));
  const data = unitsData(units), most = Math.max(40, ...data.slice(1).flat().filter((v) => v != null));
  unitsChart.show(data, { x: [0, 160], y: [0, Math.ceil(most / 20) * 20] });
  $("units").replaceChildren(...units.map(({ source, parameters: p, connection }, i) => {
    const [r, sd] = p ? resistanceAt(p, 100 / KMH) : [];
    const words = p ? LEARNED[p.learned] ?? p.learned : LINK[connection.state] ?? connection.state;
    const cells = [source, fixed(r, 1, 1000), half(sd, 1, 1000), fixed(p?.r0.value, 2, 1000), fixed(p?.r1.value, 3, 1000), fixed(p?.r2.value, 4, 1000), words];
    const row = document.createElement("tr");
    row.append(...cells.map((text) => Object.assign(document.createElement("td"), { textContent: text, title: text })));
    const sign = row.firstChild.insertBefore(document.createElement("i"), row.firstChild.firstChild);
    sign.style.background = `var(--${unitColour(i)})`;
    return row;
  }));
}

/** The other units change slowly: they are asked for now and then. Without others there is no such part. */
async function askUnits() {
  try {
    const units = await fetch("/units").then((answer) => answer.json());
    if (units.length < LEAST_UNITS) return;
    document.body.classList.add("several");
    showUnits(units);
  } catch {
    // The display has ended; what is shown says so.
  }
  setTimeout(askUnits, UNITS_MS);
}

// ---- effort, brake, past runs

function showEffort() {
  const { effort, features } = state.now, train = state.setup.train;
  const kg = train ? train.mass_kg * train.rotating_mass_factor : null;
  const [most, least] = [effort?.max_traction_n_per_kg, effort?.max_brake_n_per_kg], u = effort?.effort_n_per_kg;
  put("effort", fixed(u, 0, 1000));
  put("effort-kn", kg && u != null ? `${fixed(u * kg, 0, 1e-3)} kN` : "");
  put("effort-most", fixed(most, 0, 1000));
  put("effort-least", fixed(least == null ? null : -least, 0, 1000));
  put("acceleration", fixed(effort?.acceleration_mps2, 3));
  put("gradient", fixed(effort?.gradient_n_per_kg, 1, 1000));
  // The scale is that of the largest bounds so far: zero stays where it is.
  const scale = state.scale;
  if (effort) [scale.least, scale.most] = [Math.max(scale.least, least), Math.max(scale.most, most)];
  const at = (value) => (100 * (Math.min(scale.most, Math.max(-scale.least, value)) + scale.least)) / (scale.most + scale.least);
  const [allowed, fill, zero] = $("gauge").children;
  const bar = (span, from, to) => { span.style.left = at(from) + "%"; span.style.width = at(to) - at(from) + "%"; };
  bar(allowed, -(least ?? 0), most ?? 0);
  bar(fill, Math.min(0, u ?? 0), Math.max(0, u ?? 0));
  fill.classList.toggle("brake", u < 0);
  zero.style.left = at(0) + "%";
  put("power-most", fixed(features?.max_power_w_per_kg, 2));
  put("power-most-mw", kg && features?.max_power_w_per_kg != null ? `${fixed(features.max_power_w_per_kg * kg, 2, 1e-6)} MW` : "");
  const power = features?.power_w_per_kg.count ? features.power_w_per_kg : null;
  put("power-mean", fixed(power?.mean, 2));
  put("power-mean-sd", deviation(power?.count > 1 ? power.sd : null, 2));
}

function showBrake() {
  const { features } = state.now;
  [...$("brake").rows].forEach((row, i) => {
    const rate = features?.brake_rate_mps2[i].count ? features.brake_rate_mps2[i] : null;
    const [, mean, sd, bar] = row.cells;
    mean.textContent = fixed(rate?.mean, 2);
    sd.textContent = deviation(rate?.count > 1 ? rate.sd : null, 2);
    bar.firstChild.value = rate?.mean ?? 0;
  });
  put("cruise", fixed(features?.cruise_speed_median_mps, 1, KMH));
}

const PAST_ROWS = 5;

function showPast() {
  const rows = state.past.toReversed().map(({ summary, features }) => {
    const [r0, r1, r2] = summary.run_davis.map((term) => term.value);
    return [summary.run, fixed(features?.final_coast?.duration_s, 0), fixed(features?.final_brake?.duration_s, 0), fixed(features?.cruise_speed_median_mps, 0, KMH),
      fixed(describedAt({ r0, r1, r2 }, 100 / KMH), 1, 1000), fixed(summary.learned_s, 0)];
  });
  while (rows.length < PAST_ROWS) rows.push(Array(6).fill(NONE));
  $("past").replaceChildren(...rows.map((row) => {
    const line = document.createElement("tr");
    line.append(...row.map((text) => Object.assign(document.createElement("td"), { textContent: text })));
    return line;
  }));
}

// ---- link and board

const LINK = { opening: "opening", open: "receiving", lost: "link lost", ended: "end of the recording" };

function showLink() {
  const { link } = state, { status, health, versions, recorder } = state.now;
  let word = link?.connection.state ?? "opening", text = `${LINK[word] ?? word} · ${link?.source ?? ""}`;
  if (word === "lost") text = `${LINK.lost} · ${link.connection.error.includes(link.source) ? "" : link.source + ": "}${link.connection.error}`;
  if (word === "open" && link.silent) [word, text] = ["silent", `${age(link)} · ${link.source}`];
  if (state.gone) [word, text] = ["gone", "the display program has ended"];
  $("link-state").dataset.state = word;
  put("link-text", text);
  for (const [id, count] of [["lost", link?.lost], ["damaged", link?.damaged], ["out-of-order", link?.out_of_order]]) {
    put(id, String(count ?? 0));
    $(id).classList.toggle("some", count > 0);
  }
  const causes = status?.causes.reduce((sum, count) => sum + count, 0), refusals = status?.refusals.reduce((sum, count) => sum + count, 0);
  const rows = {
    source: link?.source, "last frame": link?.age_s == null ? null : `${fixed(link.age_s, 0)} s ago`, frames: link?.frames, lost: link?.lost, damaged: link?.damaged,
    "out of order": link?.out_of_order, "runs without an end": state.missing, repeated: link?.repeated, "not understood": link?.unknown, "board restarted": link?.restarts, reconnects: link?.reconnects,
    "run under way": status && (status.running ? "yes" : "no"), train: status?.train_id?.toString(16), track: status?.track_id?.toString(16), memory: status && plain(String(status.memory)),
    "suspected sensor": suspected(),
    "speeds cut off": recorder && `true is ${fixed(3.6 * recorder.speed_offset_mps.value, 2)} km/h more; half a step is added ${recorder.put_right ? "to each" : "from the next run on"}`,
    "readings not used": causes, "requests refused": refusals, "missed by the board": status?.missed, "not sent by the board": status?.not_sent,
    firmware: versions && `${versions.firmware.join(".")} (${versions.commit == null ? "commit unknown" : versions.commit.toString(16).padStart(8, "0")}${versions.changed ? ", changed" : ""})`,
    "messages, down / up": versions && `version ${versions.downlink} / ${versions.uplink}`,
    "board up": health && `${health.uptime_s} s`, "started by": health && plain(health.reset_cause), crashes: health?.resets, "stack used": health && `${health.stack_bytes} B`, "longest tick": health && `${health.longest_us} µs`,
  };
  const list = $("link");
  if (!list.children.length) {
    list.append(...Object.keys(rows).map((name) => {
      const row = document.createElement("div");
      row.append(Object.assign(document.createElement("dt"), { textContent: name }), document.createElement("dd"));
      return row;
    }));
  }
  Object.values(rows).forEach((value, i) => { list.children[i].lastChild.textContent = value ?? NONE; });
}

// ---- all of it

const runChart = new Chart($("run-chart"), runOptions(run));
const resistanceChart = new Chart($("resistance-chart"), resistanceOptions(() =>
  state.now.parameters?.learned === "not_yet" ? "not learned yet, 95 % interval" : "this run's train, 95 % interval"));

function show() {
  showNow(); showRun(); showResistance(); showJudged(); showEffort(); showBrake(); showLink();
}

function take(update) {
  // The program that came back may have been given another train and track.
  if (state.gone) state.described = null;
  state.gone = false;
  state.now = update.now;
  state.link = update.link;
  state.missing = update.missing_runs;
  if (update.described !== state.described) ask(update.described);
  if (update.previous) state.previous = update.previous;
  if (update.from > state.points.length) return location.reload();
  state.points.length = update.from;
  for (const point of update.points) state.points.push(point);
  if (update.past) { state.past = update.past; showPast(); }
  show();
}

/** Train and track: another one is said by its number only. */
async function ask(described) {
  state.described = described;
  try {
    const setup = await fetch("/setup").then((answer) => answer.json());
    if (state.described !== described) return;
    state.setup = setup;
    drawn = "";
    show();
  } catch {
    state.described = null;
  }
}

function listen() {
  const events = new EventSource("/events");
  events.onmessage = (event) => take(JSON.parse(event.data));
  // The browser tries again by itself, and then gets everything.
  events.onerror = () => { state.gone = true; showNow(); showLink(); };
}

/** Parts, with the one of all; that of the units is there with several only. */
const views = () => (document.body.classList.contains("several") ? 8 : 7);

function go(view) {
  document.body.dataset.view = view;
  for (const button of document.querySelectorAll("[data-go]")) button.setAttribute("aria-pressed", button.dataset.go === String(view));
}

function scheme(name) {
  document.documentElement.dataset.scheme = name;
  $("scheme").querySelector("span").textContent = name === "night" ? "Day" : "Night";
  for (const chart of [runChart, resistanceChart, unitsChart]) chart?.again();
}

const prefersDark = matchMedia("(prefers-color-scheme: dark)");
function preferred() { scheme(localStorage.getItem("scheme") ?? (prefersDark.matches ? "night" : "day")); }
function other() {
  localStorage.setItem("scheme", document.documentElement.dataset.scheme === "night" ? "day" : "night");
  preferred();
}

document.querySelector("nav").addEventListener("click", (event) => {
  const button = event.target.closest("button");
  if (button?.dataset.go) go(Number(button.dataset.go));
  else if (button) other();
});
for (const section of document.querySelectorAll("section")) {
  const panel = Number(section.dataset.panel);
  section.addEventListener("dblclick", () => go(Number(document.body.dataset.view) === panel ? 0 : panel));
  section.addEventListener("keydown", (event) => { if (event.key === "Enter" && event.target === section) go(panel); });
}
document.addEventListener("keydown", (event) => {
  if ($("help").open || event.ctrlKey || event.metaKey || event.altKey) return;
  const view = Number(document.body.dataset.view);
  if (event.key >= "0" && event.key < String(views())) go(Number(event.key));
  else if (event.key === "Escape") go(0);
  else if (event.key === "ArrowRight") go((view + 1) % views());
  else if (event.key === "ArrowLeft") go((view + views() - 1) % views());
  else if (event.key === "n") other();
  else if (event.key === "?") $("help").showModal();
});
prefersDark.addEventListener("change", preferred);

// A swipe to the left or right is the next part or the one before; what scrolls up and down goes on scrolling.
const LEAST_SWIPE_PX = 60;
let finger = null;
const main = document.querySelector("main");
main.addEventListener("touchstart", ({ touches }) => (finger = touches.length === 1 ? [touches[0].clientX, touches[0].clientY] : null), { passive: true });
main.addEventListener("touchend", ({ changedTouches: [touch] }) => {
  if (!finger) return;
  const [x, y] = [touch.clientX - finger[0], touch.clientY - finger[1]];
  finger = null;
  if (Math.abs(x) < LEAST_SWIPE_PX || Math.abs(x) < 2 * Math.abs(y)) return;
  go((Number(document.body.dataset.view) + (x < 0 ? 1 : views() - 1)) % views());
}, { passive: true });

$("legend").append(...REGIMES.map((name) => {
  const item = document.createElement("span");
  item.dataset.regime = name;
  item.append(document.createElement("i"), name);
  return item;
}));
go(0);
preferred();
showPast();
show();
listen();
askUnits();
