// SPDX-License-Identifier: BSD-3-Clause
// The live page of jinkd: the state of the flight as it comes, and how old it is.
import { Charts } from "./charts.js";
import { decisionAt } from "./data.js";
import { LiveFlight, separationTo, trackName } from "./live_flight.js";
import { LiveSource } from "./live_source.js";
import { Replay } from "./replay.js";
import { COLOURS, believedKeys, candidateKeys, decisionText, key, make, measure, nominalKeys } from "./words.js";

const at = (id) => document.getElementById(id);
/** Without an event for longer the page says that it is old [ms]. */
const STALE = 1000;
const CHART_PERIOD = 250, PATH_PERIOD = 1000;

/** A replay whose flight grows: view and origin stay where they are. */
class LiveReplay extends Replay {
  frame() {
    const last = this.flight.t.length - 1, own = this.flight.own.map((column) => column[last]);
    if (!this.origin || (this.isUnknown && own[0] === own[0])) {
      this.isUnknown = own[0] !== own[0];
      this.origin = this.isUnknown ? [0, 0, 0] : own;
      this.size = Math.min(600, Math.max(60, 2 * (this.flight.separation[last] || 0)));
      this.heading = 0;
      this.isPlaced = false;
    }
    const cell = this.size / 10;  // the grid moves with the vehicle by whole cells
    this.middle = own[0] === own[0] ? own.map((x, k) => this.origin[k] + Math.round((x - this.origin[k]) / cell) * cell) : this.origin;
    this.lowest = 0;
  }

  view(name) { if (!this.isPlaced || !this.isRefreshing) super.view(name); }

  /** Builds paths and bodies anew at the present time. */
  refresh(flight) {
    const follows = this.follows;
    this.follows = false;  // the new body of the vehicle begins at the origin
    this.isRefreshing = true;
    this.show(flight, null, 0);
    this.isRefreshing = false;
    this.isPlaced = true;
    this.follow(follows);
  }
}

const flight = new LiveFlight();
const charts = new Charts(at("charts"), () => {});
let replay = null, arrived = -Infinity, charted = 0, built = 0, events = 0, state = null, shownDecision = null;
try {
  replay = new LiveReplay(at("canvas"));
} catch (error) {
  at("canvas").hidden = at("views").hidden = true;
  at("no-webgl").hidden = false;
}

/** What a pilot must not miss comes first: old data, no own position, faults. */
function showConnection() {
  const old = performance.now() - arrived, isStale = !(old < STALE);
  document.body.classList.toggle("stale", isStale);
  const isBad = isStale || !state.own || state.faults !== "none" || state.state === "critical" || state.state === "emergency"
    || state.control === "refused" || state.control === "overruled";
  at("connection").classList.toggle("bad", isBad);
  at("connection").textContent = !state ? "no data yet" : isStale ? `no data for ${measure(old / 1000, "s", 0)}: what is shown is old`
    : `${state.own ? "live" : "own position unknown"} \u00b7 control: ${state.control} \u00b7 state: ${state.state} \u00b7 faults: ${state.faults}`;
}

function showReadout() {
  const i = flight.t.length - 1, conflict = state.conflict;
  const rows = [["time", measure(state.time, "s", 1)], ["separation", measure(flight.separation[i], "m")], ["speed", measure(flight.speed[i], "m/s", 1)],
    ["commanded", measure(flight.commanded[i], "m/s", 1)], ["height", measure(flight.own[2][i], "m", 1)], ["age of own state", measure(state.own && state.own.age, "s")],
    ["guidance", state.guidance], ["manoeuvre", state.manoeuvre], ["conflict", conflict ? `${conflict.kind} ${conflict.id} in ${measure(conflict.time, "s", 1)}` : "none"],
    ["nominal path", state.nominal.length ? state.nominal[0].kind : "none"], ["work units", measure(state.work, "", 0)], ["longest step", measure(state.longest_step_ms, "ms")], ["deadlines missed", measure(state.deadlines_missed, "", 0)],
    ["decisions", measure(state.decisions, "", 0)], ["obstacles", measure(state.obstacles, "", 0)], ["closed areas", measure(state.areas, "", 0)],
    ["messages lost", measure(state.page.messages_lost, "", 0)]];
  at("readout").replaceChildren(...rows.map(([name, value]) => make("div", {}, make("dt", { textContent: name }), make("dd", { textContent: value }))));
  const own = flight.own.map((column) => column[i]);
  at("tracks").replaceChildren(...state.tracks.map((track) => make("tr", {}, make("td", { textContent: trackName(track) }),
    ...[measure(separationTo(own, track), "m"), measure(Math.hypot(...track.velocity), "m/s", 1), measure(track.radius, "m"), measure(track.age, "s")]
      .map((text) => make("td", { className: "n", textContent: text })))));
}

function showTexts() {
  at("events").replaceChildren(...flight.events.slice().reverse().map((event) =>
    make("li", { className: event.level <= 3 ? "bad" : "" }, make("span", { textContent: measure(event.time, "s", 1) }), make("span", { textContent: event.text }))));
}

function showDecision(time) {
  const decision = decisionAt(flight, time);
  if (decision === shownDecision) return;
  shownDecision = decision;
  at("legend").replaceChildren(...candidateKeys(decision));
  at("decision").textContent = decisionText(decision);
}

function nameSeries() {
  const keys = [key(COLOURS.own, "flown"), key(COLOURS.command, "commanded", { dashed: true })];
  if (flight.safety_distance !== null) keys.push(key(COLOURS.limit, `${measure(flight.safety_distance, "m")}: half extent of the safety box, JNK_HALF_XY`, { dashed: true }));
  at("series").replaceChildren(...keys, key(COLOURS.control, "jink has control", { width: 8 }), key(COLOURS.decision, "decision", { width: 6 }));
  at("paths").replaceChildren(...(replay ? [key(COLOURS.own, "flown under jink\u2019s control", { width: 4 }), key(COLOURS.mission, "flown by the autopilot", { width: 2.5 }),
    key(COLOURS.threat, "tracks"), ...believedKeys(), ...nominalKeys()] : []));
}

function take(json) {
  state = json;
  arrived = performance.now();
  ++events;
  const { run, lastText, safety_distance } = flight;
  flight.take(state);
  const time = flight.t[flight.t.length - 1];
  if (replay) {
    replay.time = time;
    if (arrived - built > PATH_PERIOD || replay.flight === undefined || flight.t.length === 1) { replay.refresh(flight); built = arrived; } else replay.setTime(time);
  }
  if (arrived - charted > CHART_PERIOD) {
    charts.time = time;
    charts.show(flight, null, 0);
    charted = arrived;
  }
  if (flight.run !== run || flight.lastText !== lastText) showTexts();
  if (flight.safety_distance !== safety_distance) nameSeries();
  showConnection();
  showReadout();
  showDecision(time);
}

charts.window = Number(at("window").value);
at("window").onchange = () => { charts.window = Number(at("window").value); };
if (replay) {
  replay.follows = true;
  for (const button of at("views").children) button.onclick = () => { if (replay.flight) replay.view(button.dataset.view); };
  at("show-candidates").onchange = () => { replay.showsCandidates = at("show-candidates").checked; replay.drawnDecision = undefined; if (replay.flight) replay.setTime(replay.time); };
  at("follow").onchange = () => { if (replay.flight) replay.follow(at("follow").checked); else replay.follows = at("follow").checked; };
}
nameSeries();
setInterval(showConnection, 250);
const source = new LiveSource(take);
/** For tests. */
window.jinkLive = { replay, charts, flight, source, showDecision, count: () => events, state: () => state };
