// SPDX-License-Identifier: BSD-3-Clause
// The flight of the live page, from made-up events: another run of jinkd, two aircraft under one id. And its stream of
// events, which is refused and comes back.
//
//     node live_flight_test.mjs
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

async function load(name) {
  const source = readFileSync(new URL(`../../toolchain/viewer/src/${name}`, import.meta.url), "utf8");
  return import(`data:text/javascript,${encodeURIComponent(source)}`);
}
const { LiveFlight, trackName } = await load("live_flight.js");
const { LiveSource } = await load("live_source.js");

function event(run, step, more = {}) {
  return { run, step, time: step / 50, own: { position: [0, 0, 50], velocity: [5, 0, 0] }, command: null, tracks: [], work: 0, control: "autopilot",
    in_control: false, nominal: [], decision: null, shapes: null, texts: [], safety_distance: 1.5, ...more };
}
const text = (number, words) => ({ number, time: 0, level: 6, text: words });
const decision = (number, time) => ({ number, time, candidates_known: 0, candidates: [] });
const track = (id, instance, x) => ({ id, instance, position: [x, 0, 50], velocity: [0, 0, 0], radius: 2, half_height: 0, age: 0 });

// The page was away while jinkd began anew: the new run's steps, texts and decisions are beyond those of the old one.
let flight = new LiveFlight();
flight.take(event(1000, 10, { texts: [text(0, "old"), text(1, "older")], decision: decision(1, 0.2) }));
flight.take(event(2000, 900, { texts: [text(0, "new")], decision: decision(1, 17.9) }));
assert.deepEqual(flight.events.map((e) => e.text), ["new"], "texts of two runs are mixed");
assert.deepEqual(flight.decisions.map((d) => d.time), [17.9], "the new run's decision is missing");
assert.deepEqual(flight.t, [18], "samples of two runs are in one flight");

// The same run goes on: a new hearer of a run is sent texts and the decision twice.
flight.take(event(2000, 905, { texts: [text(0, "new"), text(1, "newer")], decision: decision(1, 17.9) }));
assert.deepEqual(flight.events.map((e) => e.text), ["new", "newer"]);
assert.equal(flight.decisions.length, 1);
assert.equal(flight.t.length, 2);

// Two aircraft under one id, in either order.
flight = new LiveFlight();
flight.take(event(1, 1, { tracks: [track(7, 0, 100), track(7, 1, 30)] }));
flight.take(event(1, 6, { tracks: [track(7, 1, 20), track(7, 0, 90)] }));
assert.deepEqual(flight.threats.map((t) => [t.name, t.position[0]]), [["track 7", [100, 90]], ["track 7 (2)", [30, 20]]]);
assert.deepEqual(flight.separation, [28, 18]);
assert.equal(trackName(track(7, 0, 0)), "7");

// A refused connection is made anew after some seconds; one that the browser repairs itself is left to the browser.
const made = [], waiting = [], heard = [];
class Source {
  static CLOSED = 2;
  constructor(url) { Object.assign(this, { url, readyState: 0 }); made.push(this); }
  close() { this.readyState = Source.CLOSED; }
}
const events = new LiveSource((e) => heard.push(e), Source, (what, ms) => { assert.ok(ms >= 1000); waiting.push(what); });
made[0].onerror();
assert.equal(waiting.length, 0, "the browser connects again by itself");
made[0].readyState = Source.CLOSED;
made[0].onerror();
assert.deepEqual([waiting.length, made.length], [1, 1]);
waiting[0]();
made[1].onmessage({ data: '{"step": 1}' });
assert.deepEqual([made.length, made[1].url, heard], [2, "events", [{ step: 1 }]]);
events.close();
assert.equal(made[1].readyState, Source.CLOSED);

console.log("passed");
