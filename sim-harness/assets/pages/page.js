// A page wakes up: day or night, figures, tables.
"use strict";

const prefersNight = matchMedia("(prefers-color-scheme: dark)");
const isNight = () => (document.documentElement.dataset.scheme || (prefersNight.matches ? "night" : "day")) === "night";

/** What was chosen stays chosen, where the browser lets a file remember something. */
function remembered(scheme) {
  try {
    if (scheme) localStorage.setItem("rundown-scheme", scheme);
    return localStorage.getItem("rundown-scheme");
  } catch (refused) {
    return null;
  }
}

function schemeSwitch() {
  const button = document.createElement("button");
  Object.assign(button, { type: "button", id: "scheme", title: "day or night colours" });
  const words = () => (button.textContent = isNight() ? "Day" : "Night");
  const redraw = () => {
    words();
    pictures.forEach((picture) => picture.draw());
  };
  const chosen = remembered();
  if (chosen) document.documentElement.dataset.scheme = chosen;
  button.addEventListener("click", () => {
    document.documentElement.dataset.scheme = isNight() ? "day" : "night";
    remembered(document.documentElement.dataset.scheme);
    redraw();
  });
  prefersNight.addEventListener("change", redraw);
  words();
  document.querySelector("header").append(button);
}

document.addEventListener("DOMContentLoaded", () => {
  schemeSwitch();
  watchTables();
  watchFigures();
});
