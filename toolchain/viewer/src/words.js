// SPDX-License-Identifier: BSD-3-Clause
// Colours and words of the page.

export const COLOURS = { own: "#1d5fa8", other: "#a8327d", command: "#2b2f36", mission: "#8a93a0", threat: "#e07b1a", limit: "#c62828",
  nominal: "#0f9aa0", believed: "#59616d", alone: "#b06a12", control: "#d7ecd9", decision: "#1e9e3e", grid: "#d9dde3" };

// Purple, light blue and green as in Pinheiro 4.5.1; grey and dashed: never checked.
export const FATES = {
  chosen: { colour: "#1e9e3e", width: 4, text: "chosen: the cheapest one that is clear" },
  clear: { colour: "#5bb8e8", width: 2, text: "clear, but more expensive than the chosen one" },
  contact: { colour: "#8e3fa8", width: 2, text: "would touch something" },
  not_flyable: { colour: "#c9a5d6", width: 2, text: "more than the vehicle can fly" },
  more_expensive: { colour: "#7d8794", width: 1.5, dashed: true, text: "not checked: no cheaper than the chosen one" },
  budget_spent: { colour: "#d08b00", width: 1.5, dashed: true, text: "not checked: the work budget was used up" },
};

export const OUTCOMES = {
  clear: ["good", "jink did not take control: nothing was in the way, or the autopilot refused and was asked to hold"],
  avoided: ["good", "jink took control and kept the promised distance"],
  braked: ["good", "the same, and it held still for a while"],
  breach: ["bad", "nearer than promised, no contact"],
  collision: ["bad", "the bodies touched"],
  failed: ["bad", "a rule of the link or of the airspace was broken"],
};

/** Of nominal paths. */
export const NOMINAL = {
  route: { width: 2.5, text: "nominal path, as the link reports it" },
  motion: { width: 2.5, dashed: true, text: "nominal path, from the measured motion" },
};

const minus = (text) => text.replace("-", "\u2212");
/** A number with its unit; a dash where it is unknown. */
export const measure = (value, unit, digits = 2) => value === null || value === undefined || Number.isNaN(value) ? "\u2013"
  : `${minus(value.toFixed(digits))}${unit ? "\u00a0" + unit : ""}`;

/** An element with attributes (className, textContent, ...) and children. */
export function make(tag, attributes = {}, ...children) {
  const element = Object.assign(document.createElement(tag), attributes);
  element.append(...children);
  return element;
}

/** Of obstacles and closed areas as jink believes them, in space. */
export const BELIEVED = { obstacle: { opacity: 0.4, text: "obstacles, as jink believes them" }, area: { opacity: 0.16, text: "closed areas, as jink believes them" } };
/** `shapes`: those that have an entry, all without them. */
export function believedKeys(shapes = null) {
  const has = (isArea) => !shapes || shapes.some((shape) => (shape.kind === "area") === isArea);
  return [...(has(false) ? [key(COLOURS.believed, BELIEVED.obstacle.text, { width: 8, opacity: 2 * BELIEVED.obstacle.opacity })] : []),
    ...(has(true) ? [key(COLOURS.believed, BELIEVED.area.text, { width: 8, opacity: 2 * BELIEVED.area.opacity })] : [])];
}

export const nominalKeys = () => Object.values(NOMINAL).map((n) => key(COLOURS.nominal, n.text, n));

/** The entries of a legend for a decision's candidates, with their numbers. */
export function candidateKeys(decision) {
  const counts = {};
  for (const candidate of decision ? decision.candidates : []) counts[candidate.fate] = (counts[candidate.fate] || 0) + 1;
  return Object.keys(FATES).filter((fate) => counts[fate]).map((fate) => {
    const entry = key(FATES[fate].colour, `${counts[fate]} ${FATES[fate].text}`, FATES[fate]);
    entry.dataset.fate = fate;
    entry.dataset.count = counts[fate];
    return entry;
  });
}

/** The line under that legend. */
export function decisionText(decision) {
  if (!decision) return "";
  const when = measure(decision.time, "s", 1), shown = decision.candidates.length, known = decision.candidates_known ?? shown;
  if (decision.candidates_known === null) return `Decision at ${when}: the log lost it, and with it what its candidates were. ${decision.text}`;
  if (known > shown) return `${shown} of ${known} candidates of the geometric planner at ${when}: ${known - shown} are missing here. ${decision.text}`;
  return !known ? `Decision at ${when}: ${decision.text}` : `Candidates of the geometric planner at ${when}. ${decision.text}`;
}

const SVG = "http://www.w3.org/2000/svg";
export function makeSvg(tag, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** A legend's entry: a stroke and words. */
export function key(colour, text, { width = 2, dashed = false, opacity = 1 } = {}) {
  const stroke = makeSvg("svg", { width: 26, height: 8 }, makeSvg("line",
    { x1: 0, x2: 26, y1: 4, y2: 4, stroke: colour, "stroke-width": width, "stroke-opacity": opacity, "stroke-dasharray": dashed ? "5 4" : "none" }));
  return make("span", { className: "key" }, stroke, make("span", { textContent: text }));
}
