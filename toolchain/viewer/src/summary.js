// SPDX-License-Identifier: BSD-3-Clause
// What stands above the flight: cards, and the table that selects a flight.
import { make, measure, OUTCOMES } from "./words.js";

/** 1 kept, 0 broken, null unknown. */
const kept = (f) => f.outcome && f.least !== null && f.safety_distance !== null ? Number(f.least >= f.safety_distance) : null;
const least = (values) => values.length ? Math.min(...values) : null;

export function cards(flights) {
  const known = flights.filter((f) => kept(f) !== null);
  const alone = flights.filter((f) => f.alone !== null);
  const planning = flights.map((f) => f.planning_time).filter((t) => t !== null);
  const rows = [[flights.length, flights.length === 1 ? "flight" : "flights"]];
  if (known.length) rows.push([`${known.filter(kept).length} of ${known.length}`, "kept the promised distance"]);
  if (alone.length) rows.push([alone.filter((f) => f.alone <= 0).length, "of them collide without jink"]);
  if (flights.some((f) => f.least !== null)) rows.push([measure(least(flights.filter((f) => f.least !== null).map((f) => f.least)), "m"), "least separation"]);
  if (planning.length) rows.push([measure(Math.max(...planning), "ms"), "longest step that planned, on the machine that flew it"]);
  return rows.map(([number, words]) => make("div", {}, make("b", { textContent: number }), words));
}

const COLUMNS = [
  { head: "flight" },
  { head: "outcome" },
  { head: "least separation", number: true, of: (f) => measure(f.least, "m") },
  { head: "without jink", number: true, wide: true, of: (f) => measure(f.alone, "m") + (f.alone !== null && f.alone <= 0 ? " (collision)" : "") },
  { head: "when, to what", wide: true, of: (f) => f.least === null || f.least_time === null ? "\u2013" : `${measure(f.least_time, "s", 1)}, ${f.least_threat}` },
  { head: "longest planning step", number: true, wide: true, of: (f) => measure(f.planning_time, "ms") },
];

const classes = (column) => [column.number ? "n" : "", column.wide ? "wide" : ""].join(" ").trim();

function outcomeOf(flight) {
  const cell = make("td");
  const [kind] = OUTCOMES[flight.outcome] || [""];
  cell.append(flight.outcome ? make("span", { className: `badge ${kind}`, textContent: flight.outcome }) : "\u2013");
  if (!flight.as_expected) cell.append(make("div", { className: "bad soft", textContent: "not as expected" }));
  return cell;
}

/** The table; `select` gets a flight's number. */
export function table(sources, select) {
  const body = make("tbody");
  let index = 0;
  for (const source of sources) {
    if (sources.length > 1) body.append(make("tr", { className: "source" }, make("td", { colSpan: COLUMNS.length, textContent: source.name })));
    for (const flight of source.flights) {
      const number = index++;
      const row = make("tr", { onclick: () => select(number) },
        make("td", {}, make("button", { textContent: flight.title }), make("div", { className: "soft", textContent: flight.origin })), outcomeOf(flight),
        ...COLUMNS.slice(2).map((column) => make("td", { className: classes(column), textContent: column.of(flight) })));
      row.dataset.index = number;
      body.append(row);
    }
  }
  return make("table", {}, make("thead", {}, make("tr", {}, ...COLUMNS.map((c) => make("th", { className: classes(c), textContent: c.head, scope: "col" })))), body);
}

export function outcomes(flights) {
  const present = Object.keys(OUTCOMES).filter((name) => flights.some((f) => f.outcome === name));
  return present.map((name) => `${name}: ${OUTCOMES[name][1]}`).join("; ") + (present.length ? "." : "");
}
