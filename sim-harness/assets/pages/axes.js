// What all charts share, those of the display and those of the pages: colours of the style sheet, axes, scales.
"use strict";

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

function axis(size, px, extra) {
  return {
    stroke: () => colour("dim"), font: px + "px system-ui, sans-serif", size,
    grid: { stroke: () => colour("faint"), width: 1 }, ticks: { stroke: () => colour("line"), width: 1, size: 4 }, gap: 2,
    ...extra,
  };
}

/** As it is set, also without data. */
const exact = (u, min, max) => [min, max];
