// The live form of a figure: zoom, values under the cursor, linked cursors, location or time, legend that switches off.
// The figure as SVG stays in the page: for printing, for export, and for browsers without scripts.
"use strict";

const CURSOR_REACH_PX = 40;

/** All live plots of the page, and the part of an x axis that is zoomed into, by the axis' name. */
const plots = new Set();
const zoomed = new Map();

/** With as many digits as are worth reading, and a true minus sign. */
const short = (value) => String(+value.toPrecision(5)).replace("-", "\u2212");

const ticks = (u, values, axis, space, step) => {
  let decimals = 0;
  while (decimals < 12 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6) decimals++;
  return values.map((value) => (+value.toFixed(decimals)).toFixed(decimals).replace("-", "\u2212"));
};

/** Width of a letter of the axes, px, on the wide side. */
const LETTER_PX = 7.2;

/** Room for half of the longest number at the right end of an x axis, px. */
function edge([from, to]) {
  const decimals = Math.max(0, Math.ceil(-Math.log10((to - from) / 8)));
  const letters = Math.max(...[from, to].map((x) => x.toFixed(Math.min(decimals, 12)).length));
  return Math.max(12, Math.ceil(0.5 * LETTER_PX * letters));
}

/** Width of a y axis: the same in all plots, so that they align, but where numbers are longer. */
const wide = (least) => (u, values) => Math.max(least, ...(values || []).map((text) => Math.ceil(LETTER_PX * (text || "").length) + 8));

/** Steps of an axis that counts. */
const WHOLE = [1, 2, 5].flatMap((step) => Array.from({ length: 7 }, (_, power) => step * 10 ** power)).sort((a, b) => a - b);

/** Arrays of layers stand once in the data; here they come into their places. */
function unpack(drawing) {
  const names = ["x", "y", "to", "high", "strength"];
  for (const layer of drawing.views.flatMap((view) => view.figures).flatMap((figure) => figure.panels).flatMap((panel) => panel.layers)) {
    for (const name of names) if (layer[name] !== undefined) layer[name] = drawing.arrays[layer[name]];
  }
  return drawing;
}

/** Gives each layer with a legend its series; out: what uPlot finds values in, all layers over one x. */
function aligned(figure, panel) {
  const named = panel.layers.filter((layer) => layer.legend);
  const valued = named.filter((layer) => layer.y && layer.opacity !== 0 && !layer.many);
  const xs = [...new Set(valued.flatMap((layer) => layer.x).concat(figure.x))].filter((x) => x !== null).sort((a, b) => a - b);
  const place = new Map(xs.map((x, i) => [x, i]));
  const data = [xs];
  named.forEach((layer, i) => {
    layer.series = i + 1;
    layer.at = [];
    const values = new Array(xs.length).fill(null);
    if (valued.includes(layer)) {
      layer.x.forEach((x, j) => {
        if (x === null || layer.y[j] === null) return;
        values[place.get(x)] = layer.y[j];
        layer.at[place.get(x)] = j;
      });
    }
    data.push(values);
  });
  return [named, data];
}

/** The value next to the cursor; none where the layer has none near it. */
function nearest(named) {
  return (u, series, index, x) => {
    if (series === 0 || index === null) return index;
    const layer = named[series - 1], values = u.data[series], xs = u.data[0];
    if (!layer.at.length) return null;
    if (layer.kind === "columns") {
      while (index >= 0 && (xs[index] > x || values[index] === null)) index--;
      return index >= 0 && x <= layer.to[layer.at[index]] ? index : null;
    }
    let [left, right] = [index, index];
    while (left >= 0 && values[left] === null) left--;
    while (right < xs.length && values[right] === null) right++;
    const distance = (at) => (xs[at] === undefined ? Infinity : Math.abs(xs[at] - x));
    const found = distance(left) <= distance(right) ? left : right;
    // A level line has a value everywhere.
    const reach = layer.kind === "line" && layer.x.length === 2 ? Infinity : Math.abs(u.posToVal(CURSOR_REACH_PX, "x") - u.posToVal(0, "x"));
    return distance(found) <= reach ? found : null;
  };
}

function valueOf(layer) {
  return (u, value, series, index) => {
    if (index === null || index === undefined || value === null || value === undefined) return "";
    const at = layer.at[index];
    return layer.kind === "band" ? `${short(layer.y[at])} to ${short(layer.high[at])}` : short(value);
  };
}

function seriesOf(layer) {
  const isArea = !["line", "verticals", ...POINTS].includes(layer.kind);
  const area = () => (layer.kind === "cells" ? `linear-gradient(to right, ${shade(layer.colour)}, transparent)` : shade(layer.colour, Math.max(layer.opacity ?? 1, 0.25)));
  return {
    label: layer.legend, class: POINTS.includes(layer.kind) || layer.kind === "cells" ? layer.kind : isArea ? "area" : `line-${layer.stroke}`,
    stroke: () => shade(layer.colour), fill: () => (isArea ? area() : "transparent"),
    paths: () => null, points: { show: false }, value: valueOf(layer),
  };
}

/** Takes the part of the x axis that one plot shows to all that have this axis. */
function follow(u, key) {
  if (!u.rundown.ready || key !== "x" || u.rundown.following) return;
  const { min, max } = u.scales.x, [from, to] = u.rundown.figure.x;
  if (min === from && max === to) zoomed.delete(u.rundown.figure.x_label);
  else zoomed.set(u.rundown.figure.x_label, [min, max]);
  for (const other of plots) {
    if (other === u || other.rundown.figure.x_label !== u.rundown.figure.x_label) continue;
    other.rundown.following = true;
    other.batch(() => other.setScale("x", { min, max }));
    other.rundown.following = false;
  }
  for (const plot of plots) plot.rundown.picture.buttons();
}

/** Everything with this x axis as it was at first. */
function reset(label) {
  zoomed.delete(label);
  for (const plot of plots) {
    const { figure, panel } = plot.rundown;
    if (figure.x_label !== label) continue;
    plot.rundown.following = true;
    plot.batch(() => {
      plot.setScale("x", { min: figure.x[0], max: figure.x[1] });
      plot.setScale("y", { min: panel.y[0], max: panel.y[1] });
    });
    plot.rundown.following = false;
    plot.rundown.picture.buttons();
  }
}

function optionsOf(picture, figure, panel, named, isLast) {
  const px = 12, width = picture.box.clientWidth < 500 ? 48 : 56, isStrip = panel.axes === "strip";
  const unit = figure.x_label.split(", ").slice(1).join(", ");
  const none = { size: 8, values: () => [] };
  return {
    padding: [8, panel.axes === "both" ? 12 : edge(figure.x), 0, 0],
    scales: { x: { time: false, auto: false, range: exact }, y: { auto: false, range: exact } },
    axes: [
      axis(26, px, isLast ? { values: ticks, ...(figure.is_count ? { incrs: WHOLE } : {}), label: figure.x_label, labelSize: 20, labelFont: px + "px system-ui, sans-serif", labelGap: 0 } : none),
      axis(wide(width), px, isStrip ? { values: () => [], grid: { show: false }, ticks: { show: false } } : { values: ticks, space: 24 }),
      ...(panel.axes === "both" ? [axis(wide(width), px, { values: ticks, space: 24, side: 1, scale: "y", grid: { show: false } })] : []),
    ],
    legend: { markers: { width: 2 } },
    cursor: {
      drag: { x: true, y: !isStrip, uni: 40, dist: 5 }, dataIdx: nearest(named),
      points: { size: (u, series) => (named[series - 1].kind === "line" && named[series - 1].x.length > 2 ? 7 : 0), fill: (u, series) => shade(named[series - 1].colour) },
      bind: { dblclick: () => () => reset(figure.x_label) },
      sync: { key: figure.x_label, scales: ["x", null], filters: { pub: (type) => type === "mousemove" || type === "mouseleave" } },
    },
    series: [{ label: "at", value: (u, x) => (x === null || x === undefined ? "" : `${short(x)} ${unit}`) }, ...named.map(seriesOf)],
    hooks: {
      init: [(u) => (u.rundown = { picture, figure, panel })],
      ready: [(u) => (u.rundown.ready = true), zoomsByTouch],
      setScale: [follow],
      // Before the cursor's dots and after the grid.
      drawAxes: [(u) => drawLayers(u, panel)],
    },
  };
}

/** A series by its panel: panels share names of series. */
const inPanel = (panel, series) => `${panel.label}\n${series.label}`;

/** A figure of the page, live. */
class Picture {
  constructor(element) {
    this.element = element;
    this.drawing = unpack(JSON.parse(element.querySelector("script").textContent));
    this.view = this.drawing.views[0].name;
    this.box = element.insertBefore(document.createElement("div"), element.firstChild);
    this.box.className = "live";
    this.box.setAttribute("role", "group");
    this.box.setAttribute("aria-label", this.drawing.title);
    this.bar = this.toolbar();
    element.insertBefore(this.bar, this.box);
    element.classList.add("is-live");
    this.plots = [];
    new ResizeObserver(() => this.resize()).observe(this.box);
    this.draw();
  }

  toolbar() {
    const bar = document.createElement("div");
    bar.className = "toolbar";
    const button = (text, title, act) => {
      const made = bar.appendChild(document.createElement("button"));
      Object.assign(made, { type: "button", textContent: text, title });
      made.addEventListener("click", act);
      return made;
    };
    this.choices = this.drawing.views.length < 2 ? [] : this.drawing.views.map(({ name }) => button(`over ${name}`, `x axis: ${name}`, () => showOver(name)));
    this.whole = button("whole axis", "ends the zoom, as a double click does", () => this.plots.forEach((u) => reset(u.rundown.figure.x_label)));
    button("SVG", "saves the figure as SVG", () => this.save());
    this.hint = bar.appendChild(document.createElement("small"));
    this.hint.textContent = "drag over a plot to zoom";
    return bar;
  }

  buttons() {
    this.choices.forEach((choice, i) => choice.setAttribute("aria-pressed", String(this.drawing.views[i].name === this.view)));
    const isPart = ({ scales: { x, y }, rundown: { figure, panel } }) => x.min !== figure.x[0] || x.max !== figure.x[1] || y.min !== panel.y[0] || y.max !== panel.y[1];
    this.whole.disabled = !this.plots.some(isPart);
    this.hint.hidden = !this.whole.disabled;
  }

  draw() {
    const hidden = (u) => u.series.filter((series) => !series.show).map((series) => inPanel(u.rundown.panel, series));
    const off = new Set(this.plots.flatMap(hidden));
    this.remove();
    const { figures } = this.drawing.views.find((view) => view.name === this.view);
    this.box.style.setProperty("--columns", figures.length > 1 ? this.drawing.columns : 1);
    for (const figure of figures) {
      const part = this.box.appendChild(document.createElement("div"));
      figure.panels.forEach((panel, i) => this.plot(part, figure, panel, i + 1 === figure.panels.length, off));
    }
    this.buttons();
  }

  plot(part, figure, panel, isLast, off) {
    const box = part.appendChild(document.createElement("div"));
    box.className = "plot";
    box.appendChild(document.createElement("b")).textContent = panel.label;
    const [named, data] = aligned(figure, panel);
    const size = { width: box.clientWidth, height: Math.max(70, Math.round(panel.height / 2)) + (isLast ? 54 : 16) };
    const u = new uPlot({ ...size, ...optionsOf(this, figure, panel, named, isLast) }, data, box);
    const [min, max] = zoomed.get(figure.x_label) || figure.x;
    u.batch(() => {
      u.setScale("x", { min, max });
      u.setScale("y", { min: panel.y[0], max: panel.y[1] });
      u.series.forEach((series, i) => off.has(inPanel(panel, series)) && u.setSeries(i, { show: false }));
    });
    plots.add(u);
    this.plots.push(u);
  }

  resize() {
    for (const u of this.plots) {
      const width = u.root.parentNode.clientWidth;
      if (width > 40 && width !== u.width) u.setSize({ width, height: u.height });
    }
  }

  remove() {
    for (const u of this.plots) {
      plots.delete(u);
      u.destroy();
    }
    this.plots = [];
    this.box.textContent = "";
  }

  save() {
    const text = new XMLSerializer().serializeToString(this.element.querySelector("svg"));
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
    link.download = `${this.drawing.title.replace(/[^\w.-]+/g, "_")}.svg`;
    link.click();
    URL.revokeObjectURL(link.href);
  }
}

const pictures = [];

/** All figures that can, over location or over time. */
function showOver(name) {
  for (const picture of pictures) {
    if (picture.view === name || !picture.drawing.views.some((view) => view.name === name)) continue;
    picture.view = name;
    picture.draw();
  }
}

/** Makes figures live when they come near the screen: a page of many opens at once. */
function watchFigures() {
  const watcher = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      watcher.unobserve(target);
      const picture = new Picture(target);
      pictures.push(picture);
      const name = pictures[0].view;
      if (picture.view !== name && picture.drawing.views.some((view) => view.name === name)) {
        picture.view = name;
        picture.draw();
      }
    }
  }, { rootMargin: "800px" });
  document.querySelectorAll("figure.picture").forEach((figure) => watcher.observe(figure));
}
