// SPDX-License-Identifier: BSD-3-Clause
// The last seconds of a flight, from events of jinkd (docs/guides/live_page.md), in the form that charts and replay show.

/** Samples that are kept: 120 s. */
const KEPT = 1200;
const MOST_TEXTS = 200;
const UNKNOWN = [NaN, NaN, NaN];
const vectorOf = (v) => (v ? v.map((x) => (x === null ? NaN : x)) : UNKNOWN);

/** From the own centre to a track's surface [m]; NaN where a position is unknown. */
export function separationTo(own, track) {
  const at = vectorOf(track.position);
  const up = Math.max(0, Math.abs(own[2] - at[2]) - (track.half_height || 0));
  return Math.hypot(own[0] - at[0], own[1] - at[1], up) - (track.radius || 0);
}

/** Two aircraft under one id differ in their instance. */
export const trackName = (track) => `${track.id}${track.instance ? ` (${track.instance + 1})` : ""}`;

export class LiveFlight {
  constructor() { this.clear(); }

  clear() {
    const columns = () => [[], [], []];
    Object.assign(this, { name: "live", t: [], own: columns(), velocity: columns(), command: columns(), separation: [], work: [], speed: [],
      commanded: [], phases: [], events: [], decisions: [], threats: [], mission: columns(), safety_distance: null, least: null,
      least_time: NaN, run: null, step: -1, lastDecision: null, lastText: -1, nominal: { t: [], paths: [] }, shapes: { t: [], lists: [] } });
  }

  /** Takes one event of jinkd. */
  take(state) {
    if (state.run !== this.run) this.clear();  // jinkd began anew
    this.run = state.run;
    this.takeShapes(state.shapes);
    if (state.step === this.step) { this.takeTexts(state); return; }
    this.step = state.step;
    this.safety_distance = state.safety_distance;
    const own = vectorOf(state.own && state.own.position), velocity = vectorOf(state.own && state.own.velocity), command = vectorOf(state.command);
    this.t.push(state.time);
    for (let k = 0; k < 3; ++k) { this.own[k].push(own[k]); this.velocity[k].push(velocity[k]); this.command[k].push(command[k]); }
    this.speed.push(Math.hypot(...velocity));
    this.commanded.push(Math.hypot(...command));
    this.work.push(state.work);
    const separations = state.tracks.map((track) => separationTo(own, track)).filter((d) => d === d);
    this.separation.push(separations.length ? Math.min(...separations) : NaN);
    this.takeTracks(state.tracks);
    const last = this.phases[this.phases.length - 1];
    if (!last || last.mode !== state.control) this.phases.push({ from: state.time, mode: state.control, in_control: state.in_control });
    this.nominal = { t: [state.time], paths: [state.nominal] };
    this.takeTexts(state);
    this.takeDecision(state.decision);
    if (this.t.length > KEPT) this.forget();
    const known = this.separation.filter((d) => d === d);
    this.least = known.length ? Math.min(...known) : null;
  }

  /** A new hearer is sent the newest one, and that since the last event twice. Of older ones the time alone is kept. */
  takeDecision(decision) {
    if (!decision || decision.number === this.lastDecision) return;
    this.lastDecision = decision.number;
    for (const older of this.decisions) Object.assign(older, { candidates: [], candidates_known: 0 });
    const said = this.events.find((e) => e.time === decision.time && e.text.includes(", new manoeuvre"));
    this.decisions.push({ ...decision, text: said ? said.text : "" });
  }

  /** They come when they have changed, and to a new hearer; null: they stay. Shown are the newest alone, at all times. */
  takeShapes(shapes) {
    if (!shapes) return;
    const obstacles = shapes.obstacles.map((o) => ({ ...o, time: shapes.time, centre: vectorOf(o.position), velocity: [0, 0] }));
    const areas = shapes.closed_areas.map((a) => ({ ...a, kind: "area", time: shapes.time, centre: [...vectorOf(a.position), (a.bottom + a.top) / 2],
      half: [0, 0, (a.top - a.bottom) / 2], turn: [1, 0, 0, 0] }));
    this.shapes = { t: [-Infinity], lists: [[...obstacles, ...areas]] };
  }

  takeTracks(tracks) {
    for (const threat of this.threats) {
      const track = tracks.find((t) => t.id === threat.id && t.instance === threat.instance);
      const at = vectorOf(track && track.position);
      for (let k = 0; k < 3; ++k) threat.position[k].push(at[k]);
      if (track) Object.assign(threat, { radius: track.radius || 0, half_height: track.half_height || 0, seen: this.step });
    }
    for (const track of tracks) {
      if (this.threats.some((t) => t.id === track.id && t.instance === track.instance)) continue;
      this.threats.push({ id: track.id, instance: track.instance, name: `track ${trackName(track)}`, form: "sphere", radius: track.radius || 0,
        half_height: track.half_height || 0, moves: true, first: this.t.length - 1, position: vectorOf(track.position).map((x) => [x]), seen: this.step });
    }
  }

  /** A new hearer is sent old texts too, and those since the last event twice. */
  takeTexts(state) {
    for (const text of state.texts) {
      if (text.number <= this.lastText) continue;
      this.lastText = text.number;
      this.events.push({ time: text.time, kind: "text", text: text.text, level: text.level });
    }
    this.events.splice(0, this.events.length - MOST_TEXTS);
  }

  /** The oldest sample goes. */
  forget() {
    for (const column of [this.t, ...this.own, ...this.velocity, ...this.command, this.separation, this.work, this.speed, this.commanded]) column.shift();
    for (const threat of this.threats) {
      if (threat.first > 0) --threat.first; else for (const column of threat.position) column.shift();
    }
    this.threats = this.threats.filter((threat) => threat.position[0].some((x) => x === x));
    const from = this.t[0];
    while (this.phases.length > 1 && this.phases[1].from <= from) this.phases.shift();
    this.decisions = this.decisions.filter((d) => d.time >= from);
  }
}
