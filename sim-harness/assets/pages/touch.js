// Zoom by touch: two fingers on a plot stretch and shift its x axis; one finger scrolls the page, as everywhere.
"use strict";

/** Fingers nearer to each other than this, px, say nothing about a scale. */
const LEAST_APART_PX = 10;

function zoomsByTouch(u) {
  /** The places on the axis that the two fingers took hold of. */
  let held = null;
  const places = (event) => {
    const { left } = u.over.getBoundingClientRect();
    return [...event.targetTouches].map((touch) => touch.clientX - left);
  };
  const isFar = ([a, b]) => Math.abs(b - a) >= LEAST_APART_PX;
  u.over.addEventListener("touchstart", (event) => {
    const px = places(event);
    held = px.length === 2 && isFar(px) ? px.map((x) => u.posToVal(x, "x")) : null;
    if (px.length === 2) event.preventDefault();
  }, { passive: false });
  u.over.addEventListener("touchmove", (event) => {
    const px = places(event);
    if (!held || px.length !== 2) return;
    event.preventDefault();
    const perPx = (held[1] - held[0]) / (px[1] - px[0]);
    // Fingers that cross would turn the axis round.
    if (!isFar(px) || !(perPx > 0)) return;
    const [least, most] = u.rundown.figure.x, begin = held[0] - perPx * px[0];
    const min = Math.max(least, begin), max = Math.min(most, begin + perPx * u.over.clientWidth);
    if (min < max) u.setScale("x", { min, max });
  }, { passive: false });
  for (const end of ["touchend", "touchcancel"]) u.over.addEventListener(end, () => (held = null));
}
