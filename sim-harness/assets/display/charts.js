// The two charts: speed over location, and the resistance over speed. Drawn by uPlot; here is what to draw.
"use strict";

const REGIMES = ["standstill", "traction", "cruise", "coast", "brake"];
const KMH = 3.6;

/** Font size of a chart's axes: that of the part it stands in. */
const fontSize = (box) => Math.max(13, Math.min(24, Math.round(box.clientHeight / 22)));

/** Makes a chart again when its box has another size. */
class Chart {
  constructor(box, options) {
    this.box = box;
    this.options = options;
    this.plot = null;
    this.data = null;
    new ResizeObserver(() => this.resize()).observe(box);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (width < 40 || height < 40) return;
    if (this.plot && this.plot.width === width && this.plot.height === height) return;
    this.plot?.destroy();
    this.plot = new uPlot({ width, height, ...this.options(this.box) }, this.data ?? [[]], this.box);
    this.again();
  }

  show(data, scales) {
    this.data = data;
    this.scales = scales;
    this.again();
  }

  again() {
    if (!this.plot || !this.data) return;
    this.plot.setData(this.data, false);
    this.plot.batch(() => {
      for (const [key, [min, max]] of Object.entries(this.scales)) this.plot.setScale(key, { min, max });
    });
    this.plot.redraw(true, true);
  }
}

/** Vertical lines with names, and the train. */
function marks(run) {
  return (u) => {
    const { ctx, bbox } = u;
    const px = uPlot.pxRatio * fontSize(u.root.parentNode);
    ctx.save();
    ctx.font = `${px}px system-ui, sans-serif`;
    ctx.textBaseline = "top";
    ctx.textAlign = "left";
    let free = -Infinity;
    for (const stop of run.stops()) {
      const x = Math.round(u.valToPos(stop.at_m / 1000, "x", true));
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      ctx.fillStyle = colour("line");
      ctx.fillRect(x - 1, bbox.top, 2, bbox.height);
      const width = ctx.measureText(stop.name).width;
      const left = Math.min(x + 4, bbox.left + bbox.width - width);
      if (left > free) {
        ctx.fillStyle = colour("dim");
        ctx.fillText(stop.name, left, bbox.top + 2);
        free = left + width + 8;
      }
    }
    const ahead = run.arrival();
    if (ahead) {
      // What coasting from here leads to, with its 90 % interval.
      const x = u.valToPos(ahead.km, "x", true), [y, low, high] = [ahead.kmh, ahead.low, ahead.high].map((kmh) => u.valToPos(kmh, "y", true));
      const half = 0.4 * px;
      ctx.strokeStyle = colour("coast");
      ctx.lineWidth = 3 * uPlot.pxRatio;
      ctx.beginPath();
      for (const [x0, y0, x1, y1] of [[x, low, x, high], [x - half, low, x + half, low], [x - half, high, x + half, high]]) {
        ctx.moveTo(x0, y0);
        ctx.lineTo(x1, y1);
      }
      ctx.moveTo(x + half, y);
      ctx.arc(x, y, half, 0, 7);
      ctx.stroke();
    }
    const train = run.train();
    if (train) {
      const x = u.valToPos(train.km, "x", true), y = u.valToPos(train.kmh, "y", true);
      ctx.fillStyle = colour(REGIMES[train.regime]);
      ctx.strokeStyle = colour("panel");
      ctx.lineWidth = 3 * uPlot.pxRatio;
      ctx.beginPath();
      ctx.arc(x, y, 0.45 * px + 3, 0, 7);
      ctx.stroke();
      ctx.fill();
    }
    ctx.restore();
  };
}

function runOptions(run) {
  return (box) => {
    const px = fontSize(box);
    const line = (label, stroke, extra) => ({ label, stroke: () => colour(stroke), width: Math.max(3, px / 5), points: { show: false }, pxAlign: 0, ...extra });
    return {
      padding: [0.6 * px, 22, 0, 0], legend: { show: false }, cursor: { drag: { x: false, y: false }, points: { size: 8 } },
      scales: { x: { time: false, auto: false, range: exact }, y: { auto: false, range: exact } },
      axes: [axis(px + 10, px, { values: (u, all) => all.map((v) => v + " km"), space: 5 * px }), axis(56, px, { values: (u, all) => all.map((v) => v.toFixed(0)), incrs: [10, 20, 40], space: 1.5 * px })],
      series: [{}, line("limit", "limit", { width: 2, dash: [8, 5] }), line("run before", "none", { width: 1.5, alpha: 0.7 }), ...REGIMES.map((name) => line(name, name))],
      hooks: { draw: [marks(run)] },
    };
  };
}

/** Rows of points as pieces of line, each with the colour of its regime; a gap stays a gap. In the order of the location, as uPlot asks. */
function pieces(points) {
  const all = [];
  for (let i = 1; i < points.length; i++) {
    const [a, b] = [points[i - 1], points[i]];
    if (!b[8]) all.push(a[0] <= b[0] ? [a, b, b[3]] : [b, a, b[3]]);
  }
  return all.sort((p, q) => p[0][0] - q[0][0]);
}

function runData(points, previous, limits, lengthM) {
  const rows = [];
  const put = (series, m, kmh) => rows.push([m / 1000, series, kmh]);
  limits.forEach((limit, i) => {
    put(0, limit.from_m, limit.kmh);
    put(0, limits[i + 1]?.from_m ?? lengthM, limit.kmh);
  });
  for (const [from, to] of pieces(previous)) {
    put(1, from[0], from[1] * KMH); put(1, to[0], to[1] * KMH); put(1, to[0], null);
  }
  for (const [from, to, regime] of pieces(points)) {
    put(2 + regime, from[0], from[1] * KMH); put(2 + regime, to[0], to[1] * KMH); put(2 + regime, to[0], null);
  }
  rows.sort((a, b) => a[0] - b[0]);
  const data = [rows.map((row) => row[0])];
  for (let series = 0; series < 7; series++) {
    let drawing = false;
    // To uPlot null is a gap; undefined is nothing of this series here, its line goes on.
    data.push(rows.map(([, of, kmh]) => {
      if (of === series) drawing = kmh !== null;
      return of === series ? kmh : drawing ? undefined : null;
    }));
  }
  return data;
}

/** No frame has the manufacturer's values. */
const manufacturerWords = (davis) => (davis ? "manufacturer (dashed)" : "manufacturer: start with --train T.toml");

const resistanceOptions = (words) => (box) => {
  const px = fontSize(box);
  const line = (stroke, extra) => ({ stroke: () => colour(stroke), points: { show: false }, pxAlign: 0, ...extra });
  return {
    padding: [0.6 * px, 3 * px, 0, 0], legend: { show: false }, cursor: { drag: { x: false, y: false } },
    scales: { x: { time: false, auto: false, range: exact }, y: { auto: false, range: exact } },
    axes: [axis(px + 10, px, { values: (u, all) => all.map((v) => v + " km/h"), space: 6 * px }), axis(48, px, { values: (u, all) => all.map((v) => v.toFixed(0)), incrs: [5, 10, 20, 50], space: 1.5 * px })],
    series: [{}, line("estimate", { width: 0 }), line("estimate", { width: 0 }), line("estimate", { width: 3 }), line("described", { width: 2.5, dash: [9, 6] })],
    bands: [{ series: [2, 1], fill: () => colour("band") }],
    hooks: { draw: [(u) => resistanceLabels(u, px, words())] },
  };
};

function resistanceLabels(u, px, words) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.font = `${px * uPlot.pxRatio}px system-ui, sans-serif`;
  ctx.textBaseline = "top";
  ctx.textAlign = "left";
  const rows = [["estimate", words], ["described", manufacturerWords(u.data[4]?.some((v) => v != null))]];
  rows.forEach(([name, text], i) => {
    ctx.fillStyle = colour(name);
    ctx.fillText(text, bbox.left + 10, bbox.top + 4 + i * 1.25 * px * uPlot.pxRatio);
  });
  ctx.fillStyle = colour("dim");
  ctx.textAlign = "right"; ctx.textBaseline = "bottom";
  ctx.fillText("mN/kg", bbox.left + bbox.width - 4, bbox.top + bbox.height - 4);
  ctx.restore();
}

const UNIT_COLOURS = ["estimate", "described", "traction", "coast", "warn", "standstill"];
const unitColour = (i) => UNIT_COLOURS[i % UNIT_COLOURS.length];

/** r(v) of so many units, each with its 95 % interval. Beyond the colours that there are lines are dashed. */
const unitsOptions = (count) => (box) => {
  const px = fontSize(box), indices = Array.from({ length: count }, (_, i) => i);
  const line = (i, width) => ({ stroke: () => colour(unitColour(i)), width, dash: i < UNIT_COLOURS.length ? [] : [9, 6], points: { show: false }, pxAlign: 0 });
  return {
    padding: [0.6 * px, 3 * px, 0, 0], legend: { show: false }, cursor: { drag: { x: false, y: false } },
    scales: { x: { time: false, auto: false, range: exact }, y: { auto: false, range: exact } },
    axes: [axis(px + 10, px, { values: (u, all) => all.map((v) => v + " km/h"), space: 6 * px }), axis(48, px, { values: (u, all) => all.map((v) => v.toFixed(0)), incrs: [5, 10, 20, 50], space: 1.5 * px })],
    series: [{}, ...indices.flatMap((i) => [line(i, 0), line(i, 0), line(i, 3)])],
    bands: indices.map((i) => ({ series: [3 * i + 2, 3 * i + 1], fill: () => colour(unitColour(i)) + "2e" })),
  };
};

/** Speeds, and for each unit the ends of the interval and the mean; none where a unit has said nothing yet. */
function unitsData(units) {
  const [kmh] = resistanceData(null, null);
  return [kmh, ...units.flatMap(({ parameters }) => resistanceData(parameters, null).slice(1, 4))];
}

/** r(v) in N/kg and its standard deviation, as `Parameters::at` of the wire. */
function resistanceAt(parameters, v) {
  const { r0, r1, r2, correlation: [c01, c02, c12] } = parameters;
  const a = r0.sd, b = v * r1.sd, c = v * v * r2.sd;
  const variance = a * a + b * b + c * c + 2 * (c01 * a * b + c02 * a * c + c12 * b * c);
  return [r0.value + v * (r1.value + v * r2.value), Math.sqrt(Math.max(0, variance))];
}

const describedAt = (davis, v) => davis.r0 + v * (davis.r1 + v * davis.r2);

function resistanceData(parameters, davis) {
  const kmh = Array.from({ length: 81 }, (_, i) => 2 * i);
  const at = kmh.map((v) => (parameters ? resistanceAt(parameters, v / KMH) : null));
  const of = (f) => at.map((r) => (r ? 1000 * f(r) : null));
  return [kmh, of(([r, sd]) => r - NINETY_FIVE * sd), of(([r, sd]) => r + NINETY_FIVE * sd), of(([r]) => r), kmh.map((v) => (davis ? 1000 * describedAt(davis, v / KMH) : null))];
}
