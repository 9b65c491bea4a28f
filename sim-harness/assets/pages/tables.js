// Tables that sort by a click on a head, and filter by text and by one of their words.
"use strict";

/** What a cell is sorted by: a number where it has one; a dash comes last. */
function keyOf(row, column) {
  const cell = row.cells[column];
  if (!cell || cell.colSpan > 1) return null;
  const text = cell.textContent.trim().replace(/\u2212/g, "-").replace(/\u00a0/g, " ");
  if (text === "" || text === "\u2013") return null;
  const number = parseFloat(text);
  return Number.isNaN(number) || !/^[-+\d.]/.test(text) || cell.tagName === "TH" ? text : number;
}

function compare(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b), "en", { numeric: true });
}

function sortBy(table, column, isDown) {
  const body = table.tBodies[0];
  const rows = [...body.rows].map((row, place) => ({ row, place, key: keyOf(row, column) }));
  rows.sort((a, b) => {
    if (a.key === null || b.key === null) return (a.key === null) - (b.key === null) || a.place - b.place;
    return (isDown ? -1 : 1) * compare(a.key, b.key) || a.place - b.place;
  });
  body.append(...rows.map(({ row }) => row));
}

/** The columns under each cell of the head, which may span rows and columns. */
function columnsOf(head) {
  const taken = [], found = new Map();
  [...head.rows].forEach((row, y) => {
    let x = 0;
    for (const cell of row.cells) {
      while ((taken[y] || [])[x]) x++;
      for (let dy = 0; dy < cell.rowSpan; dy++) {
        for (let dx = 0; dx < cell.colSpan; dx++) (taken[y + dy] = taken[y + dy] || [])[x + dx] = true;
      }
      if (cell.colSpan === 1) found.set(cell, x);
      x += cell.colSpan;
    }
  });
  return found;
}

function makeSortable(table) {
  const heads = columnsOf(table.tHead);
  for (const [head, column] of heads) {
    head.tabIndex = 0;
    head.setAttribute("aria-sort", "none");
    head.title = "sort by this column";
    const sort = () => {
      const isDown = head.getAttribute("aria-sort") === "ascending";
      for (const other of heads.keys()) other.setAttribute("aria-sort", "none");
      head.setAttribute("aria-sort", isDown ? "descending" : "ascending");
      sortBy(table, column, isDown);
    };
    head.addEventListener("click", sort);
    head.addEventListener("keydown", (event) => event.key === "Enter" && sort());
  }
}

function makeFilter(table) {
  const bar = document.createElement("form"), shown = document.createElement("output"), text = document.createElement("input");
  bar.className = "filter";
  bar.addEventListener("submit", (event) => event.preventDefault());
  Object.assign(text, { type: "search", placeholder: "filter by text" });
  text.setAttribute("aria-label", "filter by text");
  bar.append(text, shown);
  const rows = [...table.tBodies[0].rows].map((row) => ({ row, text: row.textContent.toLowerCase() }));
  const chosen = [...columnsOf(table.tHead)].filter(([head]) => head.dataset.choices !== undefined).map(([head, column]) => {
    const select = document.createElement("select");
    const words = new Set(rows.map(({ row }) => (row.cells[column] ? row.cells[column].textContent.trim() : "")).filter(Boolean));
    const name = head.dataset.choices;
    select.setAttribute("aria-label", name);
    select.append(new Option(`${name}: all`, ""), ...[...words].sort().map((word) => new Option(word, word)));
    bar.insertBefore(select, shown);
    return { select, column };
  });
  const apply = () => {
    let count = 0;
    for (const one of rows) {
      const has = ({ select, column }) => !select.value || (one.row.cells[column] && one.row.cells[column].textContent.trim() === select.value);
      one.row.hidden = !(one.text.includes(text.value.trim().toLowerCase()) && chosen.every(has));
      count += !one.row.hidden;
    }
    shown.textContent = `${count} of ${rows.length}`;
  };
  bar.addEventListener("input", apply);
  apply();
  table.closest(".wide").before(bar);
}

function watchTables() {
  document.querySelectorAll("table.sortable").forEach((table) => {
    makeSortable(table);
    makeFilter(table);
  });
}
