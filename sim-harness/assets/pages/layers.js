// What a plot holds, drawn on the canvas of uPlot: one function for each kind of layer.
"use strict";

/** The colours are made for white paper; at night their lightness is turned round, hue and strength stay. */
function shade(hex, opacity) {
  const rgb = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  const turn = isNight() ? 255 - Math.max(...rgb) - Math.min(...rgb) : 0;
  return `rgba(${rgb.map((c) => c + turn).join()},${opacity === undefined ? 1 : opacity})`;
}

const WIDTHS = { solid: 2, thin: 1.4, dashed: 1.8, dotted: 2 };
const DASHES = { solid: [], thin: [], dashed: [9, 6], dotted: [2, 4] };

/** Half of a cross. */
const MARK_PX = 5;
/** Layers of single points. */
const POINTS = ["marks", "dots"];

/** The points of the part of the axes that is shown. */
function eachShown(u, layer, point) {
  const within = ({ min, max }, value) => min <= value && value <= max;
  const { x, y } = u.scales;
  eachPoint(u, layer.x, layer.y, (px, py, i) => within(x, layer.x[i]) && within(y, layer.y[i]) && point(px, py));
}

/** Calls back with the place of each point on the canvas; without one where the line is broken. */
function eachPoint(u, xs, ys, point, gap) {
  for (let i = 0; i < xs.length; i++) {
    if (xs[i] === null || ys[i] === null) gap && gap();
    else point(u.valToPos(xs[i], "x", true), u.valToPos(ys[i], "y", true), i);
  }
}

function drawLine(u, layer) {
  const { ctx } = u;
  ctx.strokeStyle = ctx.fillStyle = shade(layer.colour, layer.opacity);
  ctx.lineWidth = WIDTHS[layer.stroke] * devicePixelRatio;
  ctx.setLineDash(DASHES[layer.stroke].map((length) => length * devicePixelRatio));
  let points = [];
  const end = () => {
    ctx.beginPath();
    // Between two gaps: a line of one point would not be seen.
    if (points.length === 1) ctx.arc(points[0][0], points[0][1], ctx.lineWidth, 0, 7);
    points.forEach(([x, y], i) => (i ? ctx.lineTo(x, y) : points.length > 1 && ctx.moveTo(x, y)));
    if (points.length === 1) ctx.fill();
    else ctx.stroke();
    points = [];
  };
  eachPoint(u, layer.x, layer.y, (x, y) => points.push([x, y]), end);
  end();
}

function drawBand(u, layer) {
  const { ctx } = u;
  ctx.fillStyle = shade(layer.colour, layer.opacity);
  let low = [], high = [];
  const end = () => {
    if (low.length === 1) ctx.fillRect(low[0][0] - 2, high[0][1], 4, low[0][1] - high[0][1]);
    ctx.beginPath();
    low.concat(high.reverse()).forEach(([x, y]) => ctx.lineTo(x, y));
    ctx.fill();
    low = [];
    high = [];
  };
  eachPoint(u, layer.x, layer.y, (x, y, i) => {
    low.push([x, y]);
    high.push([x, u.valToPos(layer.high[i], "y", true)]);
  }, end);
  end();
}

function drawBars(u, layer) {
  const { ctx, bbox } = u;
  ctx.fillStyle = shade(layer.colour, layer.opacity);
  const [bottom, top] = layer.heights ? layer.heights.map((y) => u.valToPos(y, "y", true)) : [bbox.top + bbox.height, bbox.top];
  layer.x.forEach((from, i) => {
    const [a, b] = [from, layer.to[i]].map((x) => u.valToPos(x, "x", true));
    // A single sample must still be seen.
    ctx.fillRect(Math.min(a, b), top, Math.max(Math.abs(b - a), 2), bottom - top);
  });
}

function drawMarks(u, layer) {
  const { ctx } = u, half = MARK_PX * devicePixelRatio;
  ctx.strokeStyle = shade(layer.colour);
  ctx.lineWidth = 2 * devicePixelRatio;
  ctx.beginPath();
  eachShown(u, layer, (x, y) => {
    for (const way of [half, -half]) {
      ctx.moveTo(x - half, y - way);
      ctx.lineTo(x + half, y + way);
    }
  });
  ctx.stroke();
}

function drawDots(u, layer) {
  const { ctx } = u, radius = 2.6 * devicePixelRatio;
  ctx.fillStyle = shade(layer.colour, layer.opacity);
  eachShown(u, layer, (x, y) => {
    ctx.beginPath();
    ctx.arc(x, y, radius, 0, 7);
    ctx.fill();
  });
}

function drawVerticals(u, layer) {
  const { ctx, bbox } = u;
  ctx.strokeStyle = shade(layer.colour);
  ctx.lineWidth = WIDTHS[layer.stroke] * devicePixelRatio;
  ctx.setLineDash(DASHES[layer.stroke].map((length) => length * devicePixelRatio));
  ctx.beginPath();
  for (const at of layer.x) {
    const x = u.valToPos(at, "x", true);
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
  }
  ctx.stroke();
}

function drawColumns(u, layer) {
  const { ctx } = u, foot = u.valToPos(0, "y", true);
  ctx.fillStyle = shade(layer.colour, layer.opacity);
  ctx.strokeStyle = shade(layer.colour);
  ctx.lineWidth = devicePixelRatio;
  eachPoint(u, layer.x, layer.y, (x, y, i) => {
    if (!layer.y[i]) return;
    const width = u.valToPos(layer.to[i], "x", true) - x;
    ctx.fillRect(x, y, width, foot - y);
    ctx.strokeRect(x, y, width, foot - y);
  });
}

function drawCells(u, layer) {
  const { ctx } = u;
  layer.x.forEach((from, i) => {
    const [x0, x1] = [from, layer.to[i]].map((x) => u.valToPos(x, "x", true));
    const [y0, y1] = [layer.y[i], layer.high[i]].map((y) => u.valToPos(y, "y", true));
    ctx.fillStyle = shade(layer.colour, layer.strength[i]);
    ctx.fillRect(x0, y1, x1 - x0 + 0.5, y0 - y1 + 0.5);
  });
}

function drawWord(u, layer) {
  const { ctx, bbox } = u;
  ctx.font = `${13 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textAlign = "left";
  ctx.textBaseline = "bottom";
  ctx.fillStyle = colour("ink");
  const [text, y] = layer.word;
  ctx.fillText(text, bbox.left + 6, u.valToPos(y, "y", true));
}

const DRAW = {
  line: drawLine, band: drawBand, bars: drawBars, marks: drawMarks, dots: drawDots,
  verticals: drawVerticals, columns: drawColumns, cells: drawCells, word: drawWord,
};

/** Nothing is drawn beyond the plot by more than this, px of the screen. */
function clip(u, beyond) {
  const { ctx, bbox } = u, margin = beyond * devicePixelRatio;
  ctx.beginPath();
  ctx.rect(bbox.left - margin, bbox.top - margin, bbox.width + 2 * margin, bbox.height + 2 * margin);
  ctx.clip();
}

/** Draws what the legend has not switched off, from back to front, within the plot. */
function drawLayers(u, panel) {
  const { ctx, bbox } = u;
  ctx.save();
  const { min, max } = u.scales.y;
  if (panel.axes !== "strip" && min < 0 && max > 0) {
    ctx.fillStyle = colour("dim");
    ctx.fillRect(bbox.left, u.valToPos(0, "y", true), bbox.width, 1);
  }
  for (const layer of panel.layers) {
    ctx.save();
    // A point at the end of an axis is seen whole.
    clip(u, POINTS.includes(layer.kind) ? MARK_PX + 1 : 0);
    if (!layer.series || u.series[layer.series].show) DRAW[layer.kind](u, layer);
    ctx.restore();
  }
  if (panel.empty) {
    ctx.font = `${13 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = "center";
    ctx.fillStyle = colour("dim");
    ctx.fillText(panel.empty, bbox.left + bbox.width / 2, bbox.top + bbox.height / 2, bbox.width);
  }
  ctx.restore();
}
