// SPDX-License-Identifier: BSD-3-Clause
// The page of jink report: which flight is shown, at which time, and what the user presses.
import { Charts } from "./charts.js";
import { Replay } from "./replay.js";
import { decisionAt, indexAt, open, phaseAt } from "./data.js";
import { outcomes, cards, table } from "./summary.js";
import { COLOURS, believedKeys, candidateKeys, decisionText, key, make, measure, nominalKeys } from "./words.js";

const at = (id) => document.getElementById(id);
const sources = JSON.parse(at("data").textContent);
const flights = sources.flatMap((source) => source.flights);
const STEP = 0.1;

let flight = null, other = null, shift = 0, time = 0, isPlaying = false, lastFrame = 0;
let replay = null;
const charts = new Charts(at("charts"), (t) => setTime(t));
try {
  replay = new Replay(at("canvas"));
} catch (error) {
  at("canvas").hidden = at("views").hidden = true;
  at("no-webgl").hidden = false;
}

const end = () => Math.max(0, flight.t[flight.t.length - 1] || 0, other ? (other.t[other.t.length - 1] || 0) + shift : 0);

/** The flight of another input that is compared at first: of the same name, or the only one. */
function counterpart(chosen) {
  const rest = sources.filter((source) => !source.flights.includes(chosen));
  return rest.flatMap((s) => s.flights.filter((f) => f.name === chosen.name || s.flights.length === 1))[0] || null;
}

function select(chosen, compared = counterpart(chosen)) {
  flight = open(chosen);
  other = compared && open(compared);
  const firsts = [flight, other].map((f) => f && f.decisions.length ? f.decisions[0].time : null);
  // Logs begin whenever jinkd was started: first decisions are laid over each other.
  shift = other && other.origin.startsWith("flight log") && firsts.every((t) => t !== null) ? Math.round((firsts[0] - firsts[1]) * 10) / 10 : 0;
  setPlaying(false);
  at("flight").hidden = false;
  for (const row of at("flights").querySelectorAll("tr[data-index]")) row.classList.toggle("chosen", flights[row.dataset.index] === chosen);
  at("title").textContent = flight.title;
  at("origin").textContent = [flight.name, flight.origin, flight.outcome].filter((s, i, all) => s && all.indexOf(s) === i).join(" \u00b7 ");
  at("complaints").textContent = flight.complaints.join("; ");
  at("other").value = other ? flights.indexOf(other) : -1;
  at("shifting").hidden = !other;
  at("shift").value = shift;
  listEvents();
  nameSeries();
  namePaths();
  if (replay) replay.show(flight, other, shift);
  const first = flight.decisions[0];
  time = 0;
  charts.show(flight, other, shift);
  at("time").max = end();
  at("time").step = STEP;
  setTime(first ? first.time : 0);
}

function nameSeries() {
  const keys = [key(COLOURS.own, other ? `flown, ${flight.name}` : "flown"), key(COLOURS.command, "commanded", { dashed: true })];
  if (other) keys.push(key(COLOURS.other, `flown, ${other.name}${other.name === flight.name ? " (second input)" : ""}`));
  if (flight.safety_distance !== null) keys.push(key(COLOURS.limit, `${measure(flight.safety_distance, "m")}: ${flight.safety_text}`, { dashed: true }));
  keys.push(key(COLOURS.control, "jink has control", { width: 8 }), key(COLOURS.decision, "decision", { width: 6 }));
  at("series").replaceChildren(...keys);
}

/** What is drawn in space, beside candidates. */
function namePaths() {
  const keys = [key(COLOURS.own, "flown under jink\u2019s control", { width: 4 }), key(COLOURS.mission, "flown by the autopilot", { width: 2.5 })];
  if (flight.mission[0].length > 1) keys.push(key(COLOURS.mission, "mission", { dashed: true }));
  if (flight.nominal.t.length) keys.push(...nominalKeys());
  if (flight.threats.length) keys.push(key(COLOURS.threat, "threats"));
  keys.push(...believedKeys(flight.shapes.all));
  if (other) keys.push(key(COLOURS.other, `flown, ${other.name}`, { width: 2.5 }));
  at("paths").replaceChildren(...(replay ? keys : []));
}

function listEvents() {
  const rows = [...flight.events, ...flight.decisions.filter((d) => !flight.events.some((e) => e.time === d.time && e.text === d.text))
    .map((d) => ({ time: d.time, kind: "decision", text: `decision: ${d.text || "new manoeuvre"}` }))].sort((a, b) => a.time - b.time);
  at("events").replaceChildren(...rows.map((event) => {
    const row = make("li", { onclick: () => setTime(event.time) }, make("button", { textContent: measure(event.time, "s", 1) }), make("span", { textContent: event.text }));
    row.dataset.time = event.time;
    row.dataset.kind = event.kind;
    return row;
  }));
}

function setTime(wanted) {
  time = Math.min(Math.max(0, wanted), end());
  at("time").value = time;
  document.body.dataset.time = time.toFixed(3);
  if (replay) replay.setTime(time);
  charts.setTime(time);
  showReadout();
  showDecision();
  let now = null;
  for (const row of at("events").children) {
    row.classList.remove("now");
    if (row.dataset.time <= time + 1e-6) now = row;
  }
  if (now) now.classList.add("now");
}

function showReadout() {
  const rows = [["time", measure(time, "s", 1)]];
  const add = (f, seconds, suffix) => {
    const i = indexAt(f.t, seconds);
    if (i < 0) return;
    const phase = phaseAt(f, seconds);
    rows.push([`separation${suffix}`, measure(f.separation[i], "m")], [`speed${suffix}`, measure(f.speed[i], "m/s", 1)],
      [`commanded${suffix}`, measure(f.commanded[i], "m/s", 1)], [`height${suffix}`, measure(f.own[2][i], "m", 1)]);
    if (f.work) rows.push([`work units${suffix}`, measure(f.work[i], "", 0)]);
    if (phase) rows.push([`${f.work ? "control" : "mode"}${suffix}`, phase.mode]);
  };
  add(flight, time, "");
  if (other) add(other, time - shift, " (2)");
  at("readout").replaceChildren(...rows.map(([name, value]) => make("div", {}, make("dt", { textContent: name }), make("dd", { textContent: value }))));
}

function showDecision() {
  const decision = decisionAt(flight, time);
  at("legend").replaceChildren(...candidateKeys(decision));
  at("decision").textContent = decisionText(decision);
}

function toDecision(direction) {
  const times = flight.decisions.map((d) => d.time);
  const found = direction > 0 ? times.find((t) => t > time + 1e-3) : times.filter((t) => t < time - 1e-3).pop();
  if (found !== undefined) setTime(found);
}

function setPlaying(plays) {
  isPlaying = plays;
  at("play").textContent = plays ? "pause" : "play";
  if (!plays) return;
  if (time >= end() - 1e-6) setTime(0);
  lastFrame = performance.now();
  requestAnimationFrame(frame);
}

function frame(now) {
  if (!isPlaying) return;
  setTime(time + Math.min(0.25, (now - lastFrame) / 1000) * Number(at("speed").value));
  lastFrame = now;
  if (time >= end() - 1e-6) setPlaying(false); else requestAnimationFrame(frame);
}

function step(seconds) {
  setPlaying(false);
  setTime(Math.round((time + seconds) * 1000) / 1000);
}

document.addEventListener("keydown", (event) => {
  const target = event.target.tagName;
  if (!flight || event.ctrlKey || event.metaKey || event.altKey || target === "SELECT" || (target === "INPUT" && event.target.type === "number")) return;
  const seconds = event.shiftKey ? 1 : STEP;
  const actions = { ArrowLeft: () => step(-seconds), ArrowRight: () => step(seconds), Home: () => step(-1e9), End: () => step(1e9),
    n: () => toDecision(1), p: () => toDecision(-1) };
  const isButton = target === "BUTTON" || (target === "INPUT" && event.target.type === "checkbox");
  if (!isButton) actions[" "] = () => setPlaying(!isPlaying);
  if (!actions[event.key] || ((event.key === "Home" || event.key === "End") && event.target.closest("#flights"))) return;
  event.preventDefault();
  actions[event.key]();
});
at("play").onclick = () => setPlaying(!isPlaying);
at("back").onclick = () => step(-STEP);
at("forward").onclick = () => step(STEP);
at("next").onclick = () => toDecision(1);
at("time").oninput = () => { setPlaying(false); setTime(Number(at("time").value)); };
at("window").onchange = () => charts.setWindow(Number(at("window").value));
at("other").onchange = () => select(flight, flights[at("other").value] || null);
at("shift").onchange = () => {
  shift = Number(at("shift").value) || 0;
  at("time").max = end();
  if (replay) replay.shift = shift;
  charts.show(flight, other, shift);
  setTime(time);
};
if (replay) {
  for (const button of at("views").children) button.onclick = () => replay.view(button.dataset.view);
  at("follow").onchange = () => replay.follow(at("follow").checked);
  at("show-candidates").onchange = () => { replay.showsCandidates = at("show-candidates").checked; replay.drawnDecision = undefined; replay.setTime(time); };
}

const promised = [...new Set(flights.filter((f) => f.outcome && f.safety_distance).map((f) => f.safety_distance))].map((d) => measure(d, "m", 1));
at("promise").textContent = promised.length ? "jink sits beside a drone\u2019s autopilot. When it sees a collision ahead, it takes control, flies around what is in "
  + `the way, and gives control back. It promises that the drone\u2019s centre stays ${promised.join(" or ")} away from every true surface.` : "";
at("cards").replaceChildren(...cards(flights));
at("flights").replaceChildren(table(sources, (index) => select(flights[index])));
at("outcomes").textContent = outcomes(flights);
at("comparing").hidden = flights.length < 2;
at("other").append(make("option", { value: -1, textContent: "nothing" }), ...flights.map((f, i) =>
  make("option", { value: i, textContent: sources.length > 1 ? `${f.name} (${sources.findIndex((s) => s.flights.includes(f)) + 1})` : f.name })));
if (flights.length) select(flights[0]); else at("promise").textContent = "The run holds no flights.";
/** For tests. */
window.jinkViewer = { replay, charts, select, flights, state: () => ({ flight, other, shift, time, isPlaying }) };
