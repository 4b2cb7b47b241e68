// SPDX-License-Identifier: BSD-3-Clause
// Flights as `jink report` writes them (toolchain/host/flight_page.hpp), with columns as arrays of numbers.

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** Float64Array of a column; NaN where the value is unknown. */
export function decode(column) {
  const bytes = bytesOf(column.data);
  const view = new DataView(bytes.buffer);
  const values = new Float64Array(bytes.length / column.bytes);
  const unknown = column.bytes === 2 ? 0xffff : 0xffffffff;
  for (let i = 0; i < values.length; ++i) {
    const code = column.bytes === 2 ? view.getUint16(2 * i, true) : view.getUint32(4 * i, true);
    values[i] = code === unknown ? NaN : column.from + column.step * code;
  }
  return values;
}

const decode3 = (columns) => columns.map(decode);
const length3 = (columns) => columns[0].map((x, i) => Math.hypot(x, columns[1][i], columns[2][i]));

/** Columns of nominal paths as {t, paths}: the paths of each time together. */
function openNominal({ t, on_route, sizes, points }) {
  const times = decode(t), kinds = decode(on_route), counts = decode(sizes), columns = decode3(points), nominal = { t: [], paths: [] };
  for (let i = 0, first = 0; i < times.length; first += counts[i++]) {
    if (i === 0 || times[i] !== times[i - 1]) { nominal.t.push(times[i]); nominal.paths.push([]); }
    nominal.paths[nominal.paths.length - 1].push({ kind: kinds[i] ? "route" : "motion", points: columns.map((c) => c.slice(first, first + counts[i])) });
  }
  return nominal;
}

/** Names of kinds as the page's data number them: PageShape. */
const KINDS = ["sphere", "box", "capsule", "cylinder", "hull", "area"];

/** Columns of shapes as {all, t, lists}: all of them, and those at each time at which they change. */
function openShapes(columns) {
  const [from, until, kinds, maps, radius] = ["from", "until", "kind", "of_map", "radius"].map((name) => decode(columns[name]));
  const [centre, half, turn, velocity] = ["centre", "half", "turn", "velocity"].map((name) => columns[name].map(decode));
  const row = (vectors, i) => vectors.map((column) => column[i]);
  const all = Array.from(from, (time, i) => ({ time, until: until[i], kind: KINDS[kinds[i]], of_map: maps[i] > 0, radius: radius[i],
    centre: row(centre, i), half: row(half, i), turn: row(turn, i), velocity: row(velocity, i) }));
  const t = [...new Set([...from, ...until])].sort((a, b) => a - b), lists = [];
  let begun = 0, active = [];
  for (const time of t) {
    active = active.filter((shape) => shape.until > time);
    for (; begun < all.length && all[begun].time <= time; ++begun) if (all[begun].until > time) active.push(all[begun]);
    lists.push(active.slice());
  }
  return { all, t, lists };
}

/** Decodes a flight in place, once. Vectors are [x, y, z], each an array; speeds are lengths of vectors. */
export function open(flight) {
  if (flight.isOpen) return flight;
  for (const key of ["mission", "own", "velocity", "command"]) flight[key] = decode3(flight[key]);
  for (const key of ["t", "separation"]) flight[key] = decode(flight[key]);
  flight.work = flight.work && decode(flight.work);
  flight.speed = length3(flight.velocity);
  flight.commanded = length3(flight.command);
  for (const threat of flight.threats) threat.position = decode3(threat.position);
  for (const decision of flight.decisions) {
    for (const candidate of decision.candidates) candidate.points = candidate.points && decode3(candidate.points);
  }
  flight.nominal = openNominal(flight.nominal);
  flight.shapes = openShapes(flight.shapes);
  flight.isOpen = true;
  return flight;
}

/** Index of the last sample at or before a time; -1: none. */
export function indexAt(times, time) {
  let low = -1, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time + 1e-6) low = middle; else high = middle - 1;
  }
  return low;
}

/** A point between samples; null where it is unknown. `first`: sample of the columns' first value. */
export function pointAt(times, columns, time, first = 0) {
  const i = indexAt(times, time) - first;
  if (i < 0 || i >= columns[0].length || Number.isNaN(columns[0][i])) return null;
  const next = Math.min(i + 1, columns[0].length - 1);
  const from = times[i + first], to = times[Math.min(i + 1 + first, times.length - 1)];
  const share = to > from && !Number.isNaN(columns[0][next]) ? Math.min(1, Math.max(0, (time - from) / (to - from))) : 0;
  return columns.map((c) => c[i] + share * (c[next] - c[i]));
}

/** Where a threat is; null while nothing is known of it. */
export function placeOf(flight, threat, time) {
  if (!threat.moves) {
    return threat.position[0].length ? threat.position.map((c) => c[0]) : null;
  }
  return pointAt(flight.t, threat.position, time, threat.first);
}

/** The phase at a time. */
export function phaseAt(flight, time) {
  let found = null;
  for (const phase of flight.phases) if (phase.from <= time + 1e-6) found = phase;
  return found;
}

/** [from, to] of each time in which jink's commands are flown. */
export function controlSpans(flight) {
  const end = flight.t.length ? flight.t[flight.t.length - 1] : 0;
  return flight.phases.map((p, i) => [p.from, i + 1 < flight.phases.length ? flight.phases[i + 1].from : end, p.in_control])
    .filter((span) => span[2] && span[1] > span[0]);
}

/** How long nominal paths are shown without news: they come every 0.2 s [s]. */
const NOMINAL_LIFE = 0.5;

/** The paths that conflicts were looked for along at a time, or null. */
export function nominalAt(flight, time) {
  const i = indexAt(flight.nominal.t, time);
  return i >= 0 && time <= flight.nominal.t[i] + NOMINAL_LIFE + 1e-6 ? flight.nominal.paths[i] : null;
}

const NOTHING = [];

/** Obstacles and closed areas as jink believed them at a time. */
export function shapesAt(flight, time) {
  const i = indexAt(flight.shapes.t, time);
  return i < 0 ? NOTHING : flight.shapes.lists[i];
}

/** How long a decision's candidates are shown after it, unless another one follows [s]. */
const SHOWN = 10;

/** The decision whose candidates are shown at a time, or null. */
export function decisionAt(flight, time) {
  let found = null;
  for (const decision of flight.decisions) if (decision.time <= time + 1e-6) found = decision;
  return found && time <= found.time + SHOWN ? found : null;
}
