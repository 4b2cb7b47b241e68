// SPDX-License-Identifier: BSD-3-Clause
// Charts over one time axis: separation, speed, climb, work units, and marks of decisions and events above them.
import { COLOURS, makeSvg, measure } from "./words.js";
import { controlSpans, indexAt } from "./data.js";

const LEFT = 52, RIGHT = 10, TOP = 20, LANE = 18, GAP = 24, BOTTOM = 24;
const PANELS = [
  { name: "separation", unit: "m", height: 150, of: (f) => [["own", f.separation]], limit: (f) => f.safety_distance },
  { name: "speed", unit: "m/s", height: 90, of: (f) => [["command", f.commanded], ["own", f.speed]] },
  { name: "climb", unit: "m/s", height: 80, of: (f) => [["command", f.command[2]], ["own", f.velocity[2]]] },
  { name: "work units of a step", unit: "", height: 80, of: (f) => [["own", f.work || []]] },
];

/** 1, 2 or 5 times a power of ten: at most `count` steps in `span`. */
function stepOf(span, count) {
  const raw = Math.max(span, 1e-9) / count, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((f) => f * power >= raw * 0.999);
}

function extent(lists, extra) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const v of list) if (v === v) { low = Math.min(low, v); high = Math.max(high, v); }
  for (const v of extra) if (v === v && v !== null && v !== undefined) { low = Math.min(low, v); high = Math.max(high, v); }
  return low <= high ? [low, high] : [0, 1];
}

/** Of the separation all that matters: up to some times the least and the safety distance. */
function top(flights, high) {
  const least = Math.max(...flights.map((f) => Math.max(3 * (f.least || 0), 8 * (f.safety_distance || 0), 12)));
  return Math.min(high, least);
}

export class Charts {
  /** @param box where the charts are drawn; onTime(t) when one presses there */
  constructor(box, onTime) {
    this.box = box;
    this.onTime = onTime;
    this.window = 0;
    this.time = 0;
    const move = (event) => {
      const x = event.clientX - box.getBoundingClientRect().left;
      this.onTime(Math.min(this.to, Math.max(this.from, this.from + ((x - LEFT) / this.width) * (this.to - this.from))));
    };
    box.addEventListener("pointerdown", (event) => { box.setPointerCapture(event.pointerId); move(event); });
    box.addEventListener("pointermove", (event) => { if (event.buttons & 1) move(event); });
    new ResizeObserver(() => { if (this.flight && box.clientWidth !== this.drawnWidth) this.draw(); }).observe(box);
  }

  /** `other` is drawn over `flight`, `shift` seconds later; null: nothing. */
  show(flight, other, shift) {
    Object.assign(this, { flight, other, shift });
    this.draw();
  }

  setTime(time) {
    this.time = time;
    if (this.window > 0) this.draw(); else this.placeCursor();
  }

  setWindow(seconds) {
    this.window = seconds;
    this.draw();
  }

  x(time) { return LEFT + ((time - this.from) / Math.max(this.to - this.from, 1e-9)) * this.width; }

  range() {
    const ends = [[0, this.flight], [this.shift, this.other]].filter((e) => e[1] && e[1].t.length)
      .map(([shift, f]) => [f.t[0] + shift, f.t[f.t.length - 1] + shift]);
    let from = Math.min(0, ...ends.map((e) => e[0])), to = Math.max(1, ...ends.map((e) => e[1]));
    if (this.window > 0 && this.window < to - from) {
      from = Math.min(Math.max(this.time - this.window / 2, from), to - this.window);
      to = from + this.window;
    }
    [this.from, this.to] = [from, to];
  }

  draw() {
    this.drawnWidth = this.box.clientWidth;
    this.width = Math.max(60, this.drawnWidth - LEFT - RIGHT);
    this.range();
    const flights = [this.flight, this.other].filter(Boolean);
    const panels = PANELS.filter((p) => flights.some((f) => p.of(f).some(([, v]) => v.length)));
    const height = TOP + LANE + 10 + panels.reduce((sum, p) => sum + p.height + GAP, 0) + BOTTOM - GAP + 8;
    const svg = makeSvg("svg", { height, viewBox: `0 0 ${this.drawnWidth} ${height}` });
    for (const [a, b] of controlSpans(this.flight)) {
      const left = this.x(Math.max(a, this.from)), right = this.x(Math.min(b, this.to));
      if (right > left) svg.append(makeSvg("rect", { x: left, y: TOP, width: right - left, height: height - TOP - BOTTOM, fill: COLOURS.control, class: "control" }));
    }
    let y = TOP + LANE + 16;
    for (const panel of panels) {
      this.panel(svg, panel, flights, y);
      y += panel.height + GAP;
    }
    this.timeAxis(svg, y - GAP);
    this.lane(svg);
    this.cursor = makeSvg("line", { y1: TOP - 4, y2: y - GAP, stroke: COLOURS.limit, "stroke-width": 1.5, class: "cursor" });
    svg.append(this.cursor);
    this.placeCursor();
    this.box.replaceChildren(svg);
  }

  placeCursor() {
    if (!this.cursor) return;
    for (const end of ["x1", "x2"]) this.cursor.setAttribute(end, this.x(this.time));
  }

  panel(svg, panel, flights, y) {
    const limit = panel.limit ? panel.limit(this.flight) : null;
    let [low, high] = extent(flights.flatMap((f) => panel.of(f).map(([, v]) => v)), [limit, 0]);
    if (panel.limit) high = top(flights, high);
    const step = stepOf(high - low || 1, panel.height / 32);
    low = Math.floor(low / step + 1e-9) * step;
    high = Math.max(Math.ceil(high / step - 1e-9) * step, low + step);
    const scale = (v) => y + panel.height - ((Math.min(Math.max(v, low), high) - low) / (high - low)) * panel.height;
    for (let v = low; v <= high + step / 2; v += step) {
      svg.append(makeSvg("line", { x1: LEFT, x2: LEFT + this.width, y1: scale(v), y2: scale(v), stroke: COLOURS.grid }));
      const label = makeSvg("text", { x: LEFT - 6, y: scale(v) + 4, "text-anchor": "end" });
      label.textContent = measure(v, "", step < 1 ? 1 : 0).replace("\u22120", v < -step / 2 ? "\u22120" : "0");
      svg.append(label);
    }
    const caption = makeSvg("text", { x: LEFT + 2, y: y - 5 });
    caption.textContent = panel.name + (panel.unit ? ` [${panel.unit}]` : "");
    svg.append(caption);
    if (limit !== null && limit !== undefined) {
      svg.append(makeSvg("line", { x1: LEFT, x2: LEFT + this.width, y1: scale(limit), y2: scale(limit), stroke: COLOURS.limit, "stroke-dasharray": "6 4", class: "limit" }));
    }
    if (this.other) {
      for (const [role, values] of panel.of(this.other)) {
        this.curve(svg, this.other, values, this.shift, scale, COLOURS.other, role === "command" ? 1 : 1.6, role === "command" ? "3 3" : "none", high);
      }
    }
    for (const [role, values] of panel.of(this.flight)) {
      this.curve(svg, this.flight, values, 0, scale, COLOURS[role], role === "command" ? 1 : 1.8, role === "command" ? "3 3" : "none", high);
    }
  }

  /** One path; gaps where a value is unknown. Beyond the scale's top the curve is left out. */
  curve(svg, flight, values, shift, scale, colour, width, dashes, high) {
    const first = Math.max(0, indexAt(flight.t, this.from - shift)), last = Math.min(values.length - 1, indexAt(flight.t, this.to - shift) + 1);
    let path = "", pen = false;
    for (let i = first; i <= last; ++i) {
      const v = values[i];
      if (v !== v || (v > high && (i === 0 || !(values[i - 1] <= high)) && !(values[i + 1] <= high))) { pen = false; continue; }
      path += `${pen ? "L" : "M"}${this.x(flight.t[i] + shift).toFixed(1)} ${scale(v).toFixed(1)}`;
      pen = true;
    }
    if (path) svg.append(makeSvg("path", { d: path, fill: "none", stroke: colour, "stroke-width": width, "stroke-dasharray": dashes, class: "curve" }));
  }

  timeAxis(svg, y) {
    const step = stepOf(this.to - this.from, Math.max(2, this.width / 70));
    for (let t = Math.ceil(this.from / step - 1e-9) * step; t <= this.to + 1e-6; t += step) {
      const x = this.x(t);
      svg.append(makeSvg("line", { x1: x, x2: x, y1: TOP + LANE, y2: y + 4, stroke: COLOURS.grid }));
      const label = makeSvg("text", { x, y: y + 17, "text-anchor": x > LEFT + this.width - 16 ? "end" : "middle" });
      label.textContent = measure(t, "s", step < 1 ? 1 : 0);
      svg.append(label);
    }
  }

  /** Decisions as triangles, other events as ticks. */
  lane(svg) {
    const inside = (t) => t >= this.from - 1e-6 && t <= this.to + 1e-6;
    for (const event of this.flight.events.filter((e) => inside(e.time))) {
      const x = this.x(event.time);
      const tick = makeSvg("line", { x1: x, x2: x, y1: TOP, y2: TOP + LANE - 4, stroke: event.kind === "closest" ? COLOURS.limit : COLOURS.command, "stroke-width": 1.2, class: "event" });
      tick.append(makeSvg("title"));
      tick.firstChild.textContent = `${event.time.toFixed(1)} s: ${event.text}`;
      svg.append(tick);
    }
    for (const decision of this.flight.decisions.filter((d) => inside(d.time))) {
      const x = this.x(decision.time);
      svg.append(makeSvg("path", { d: `M${x - 6} ${TOP - 8}h12l-6 10z`, fill: COLOURS.decision, class: "decision" }));
    }
    const caption = makeSvg("text", { x: 2, y: TOP + 9 });
    caption.textContent = "events";
    svg.append(caption);
  }
}
