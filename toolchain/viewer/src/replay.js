// SPDX-License-Identifier: BSD-3-Clause
// The replay in space. Scene axes: x east, y up, z south, about the flight's middle.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { BELIEVED, COLOURS, FATES, NOMINAL } from "./words.js";
import { controlSpans, decisionAt, indexAt, nominalAt, placeOf, pointAt, shapesAt } from "./data.js";

// Materials are kept: a shader whose last material is disposed of would be compiled again for the next flight.
const materials = new Map();
function kept(name, create) {
  if (!materials.has(name)) materials.set(name, create());
  return materials.get(name);
}

const solid = (colour, opacity) => kept(`solid ${colour} ${opacity}`,
  () => new THREE.MeshLambertMaterial({ color: colour, transparent: true, opacity, depthWrite: opacity > 0.5 }));

function markMaterial(colour, size) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const context = canvas.getContext("2d");
  for (const [fill, radius] of [["#ffffff", 31], [colour, 25]]) {
    context.fillStyle = fill;
    context.beginPath();
    context.arc(32, 32, radius, 0, 2 * Math.PI);
    context.fill();
  }
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  return new THREE.PointsMaterial({ map, size, sizeAttenuation: false, transparent: true, alphaTest: 0.1, depthTest: false });
}

/** A round mark of a constant size on the screen. */
function mark(colour, size) {
  const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute([0, 0, 0], 3));
  const points = new THREE.Points(geometry, kept(`mark ${colour} ${size}`, () => markMaterial(colour, size)));
  points.renderOrder = 5;
  return points;
}

function bodyOf(threat) {
  if (threat.form === "box") return new THREE.BoxGeometry(2 * threat.half_extents[0], 2 * threat.half_extents[2], 2 * threat.half_extents[1]);
  if (threat.form === "cylinder") return new THREE.CylinderGeometry(threat.radius, threat.radius, 2 * threat.half_height, 32);
  if (threat.half_height > 0) return new THREE.CapsuleGeometry(threat.radius, 2 * threat.half_height, 8, 24);
  return new THREE.SphereGeometry(threat.radius, 28, 18);
}

/** What jink believes, as the body of a threat. A hull is known by the box about it. */
function bodyOfShape({ kind, half, radius }) {
  if (kind === "box" || kind === "hull") return bodyOf({ form: "box", half_extents: half });
  if (kind === "cylinder" || kind === "area") return bodyOf({ form: "cylinder", radius, half_height: half[2] });
  return bodyOf({ form: "sphere", radius, half_height: kind === "capsule" ? half[2] : 0 });
}

/** Columns as points. */
const pointsOf = ([xs, ys, zs]) => Array.from(xs, (x, i) => [x, ys[i], zs[i]]);

function empty(group) {
  group.traverse((object) => { if (object.geometry) object.geometry.dispose(); });
  group.clear();
}

export class Replay {
  /** Throws where the browser offers no WebGL. */
  constructor(canvas) {
    const context = canvas.getContext("webgl2", { antialias: true });
    if (!context) throw new Error("no WebGL");
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.canvas = canvas;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color("#eef2f6");
    this.scene.add(new THREE.AmbientLight("#ffffff", 1.6));
    const sun = new THREE.DirectionalLight("#ffffff", 1.6);
    sun.position.set(0.4, 1, 0.7);
    this.scene.add(sun);
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.1, 1e5);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.request());
    this.ground = new THREE.GridHelper(1, 40, "#b9c2cd", "#d5dbe3");
    this.fixed = new THREE.Group();
    this.bodies = new THREE.Group();
    this.candidates = new THREE.Group();
    this.nominal = new THREE.Group();
    this.shapes = new THREE.Group();
    this.scene.add(this.ground, this.fixed, this.bodies, this.candidates, this.nominal, this.shapes);
    this.showsCandidates = true;
    this.follows = false;
    this.time = 0;
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  resize() {
    const box = this.canvas.parentElement;
    if (!box.clientWidth || !box.clientHeight) return;
    this.renderer.setSize(box.clientWidth, box.clientHeight, false);
    this.camera.aspect = box.clientWidth / box.clientHeight;
    this.camera.updateProjectionMatrix();
    this.request();
  }

  /** Draws with the next frame, however often it is called until then. */
  request() {
    this.waiting = this.waiting || requestAnimationFrame(() => this.render());
  }

  render() {
    if (this.waiting) cancelAnimationFrame(this.waiting);
    this.waiting = 0;
    this.renderer.render(this.scene, this.camera);
  }

  toScene([x, y, z]) { return new THREE.Vector3(x - this.origin[0], z - this.origin[2], this.origin[1] - y); }

  line(points, colour, width, { dashed = false, opacity = 1, order = 1 } = {}) {
    const flat = [];
    for (const p of points) { const v = this.toScene(p); flat.push(v.x, v.y, v.z); }
    const dash = dashed ? Number((this.size / 60).toPrecision(1)) : 0;
    const material = kept(`line ${colour} ${width} ${dash} ${opacity}`, () => new LineMaterial({ color: colour, linewidth: width,
      dashed, dashSize: dash, gapSize: 0.7 * dash, transparent: opacity < 1, opacity }));
    const line = new Line2(new LineGeometry().setPositions(flat), material);
    if (dashed) line.computeLineDistances();
    line.renderOrder = order;
    return line;
  }

  /** Lines through known samples, in pieces where values are unknown. */
  track(group, columns, from, to, colour, width, options) {
    let piece = [];
    const end = () => { if (piece.length > 1) group.add(this.line(piece, colour, width, options)); piece = []; };
    for (let i = from; i <= to && i < columns[0].length; ++i) {
      if (Number.isNaN(columns[0][i])) end(); else piece.push([columns[0][i], columns[1][i], columns[2][i]]);
    }
    end();
  }

  show(flight, other, shift) {
    Object.assign(this, { flight, other, shift, drawnDecision: undefined, drawnNominal: undefined, drawnShapes: undefined });
    this.frame();
    empty(this.fixed);
    empty(this.bodies);
    this.ground.scale.setScalar(this.size * 4);
    this.ground.position.copy(this.toScene([this.middle[0], this.middle[1], Math.min(0, this.lowest)]));
    if (flight.mission[0].length > 1) {
      this.fixed.add(this.line(pointsOf(flight.mission), COLOURS.mission, 1.5, { dashed: true }));
    }
    const last = flight.t.length - 1;
    this.track(this.fixed, flight.own, 0, last, COLOURS.mission, 2.5);
    for (const [from, to] of controlSpans(flight)) {
      this.track(this.fixed, flight.own, Math.max(0, indexAt(flight.t, from)), indexAt(flight.t, to), COLOURS.own, 4, { order: 2 });
    }
    if (other) this.track(this.fixed, other.own, 0, other.t.length - 1, COLOURS.other, 2.5, { order: 2 });
    this.placed = flight.threats.map((threat) => {
      if (threat.moves) this.track(this.fixed, threat.position, 0, threat.position[0].length - 1, COLOURS.threat, 1.5, { opacity: 0.6 });
      const group = new THREE.Group();
      group.add(new THREE.Mesh(bodyOf(threat), solid(COLOURS.threat, 0.7)), mark(COLOURS.threat, 9));
      this.bodies.add(group);
      return [threat, group];
    });
    this.vehicle = new THREE.Group();
    if (flight.safety_distance > 0) {
      this.vehicle.add(new THREE.Mesh(new THREE.SphereGeometry(flight.safety_distance, 24, 16), solid(COLOURS.own, 0.25)));
    }
    this.vehicle.add(mark(COLOURS.own, 15));
    this.bodies.add(this.vehicle);
    this.otherVehicle = other ? mark(COLOURS.other, 13) : null;
    if (other) this.bodies.add(this.otherVehicle);
    this.view("oblique");
    this.setTime(this.time);
  }

  /** Origin and size: of the flight under jink's control and about it, otherwise of all of it. */
  frame() {
    const flight = this.flight, spans = controlSpans(flight), low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
    const near = (t) => spans.some(([a, b]) => t > a - 4 && t < b + 3) || Math.abs(t - flight.least_time) < 4;
    const take = (all) => {
      for (let i = 0; i < flight.t.length; ++i) {
        if (Number.isNaN(flight.own[0][i]) || !(all || near(flight.t[i]))) continue;
        for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], flight.own[k][i]); high[k] = Math.max(high[k], flight.own[k][i]); }
      }
    };
    take(false);
    if (low[0] > high[0]) take(true);
    if (low[0] > high[0]) { low.fill(0); high.fill(10); }
    this.middle = low.map((v, k) => (v + high[k]) / 2);
    this.lowest = low[2];
    this.origin = this.middle;
    this.size = Math.max(12, ...low.map((v, k) => high[k] - v));
    const [dx, dy] = [0, 1].map((k) => (flight.mission[k].length > 1 ? flight.mission[k][flight.mission[k].length - 1] - flight.mission[k][0] : 1 - k));
    this.heading = Math.atan2(dy, dx);
  }

  /** "above", "side" or "oblique", relative to the mission's direction. */
  view(name) {
    const turn = { above: this.heading - Math.PI / 2, side: this.heading - Math.PI / 2, oblique: this.heading - 2.3 }[name];
    const tilt = { above: 1.5607, side: 0.04, oblique: 0.5 }[name];
    const distance = this.size * (this.camera.aspect < 1 ? 1.5 : 1.05);
    const target = this.follows && this.vehicle.visible ? this.vehicle.position : new THREE.Vector3();
    this.controls.target.copy(target);
    this.camera.position.set(target.x + distance * Math.cos(turn) * Math.cos(tilt), target.y + distance * Math.sin(tilt), target.z - distance * Math.sin(turn) * Math.cos(tilt));
    this.controls.update();
    this.request();
  }

  setTime(time) {
    this.time = time;
    const before = this.vehicle.position.clone();
    this.place(this.vehicle, pointAt(this.flight.t, this.flight.own, time));
    if (this.other) this.place(this.otherVehicle, pointAt(this.other.t, this.other.own, time - this.shift));
    for (const [threat, group] of this.placed) this.place(group, placeOf(this.flight, threat, time));
    if (this.follows && this.vehicle.visible) {
      this.camera.position.add(this.vehicle.position.clone().sub(before));
      this.controls.target.copy(this.vehicle.position);
      this.controls.update();
    }
    const decision = this.showsCandidates ? decisionAt(this.flight, time) : null;
    if (decision !== this.drawnDecision) this.drawCandidates(decision);
    const nominal = nominalAt(this.flight, time);
    if (nominal !== this.drawnNominal) this.drawNominal(nominal);
    const shapes = shapesAt(this.flight, time);
    if (shapes !== this.drawnShapes) this.drawShapes(shapes);
    this.placeShapes(time);
    this.request();
  }

  follow(follows) {
    this.follows = follows;
    if (follows && this.vehicle.visible) {
      this.camera.position.add(this.vehicle.position.clone().sub(this.controls.target));
      this.controls.target.copy(this.vehicle.position);
      this.controls.update();
    }
    this.request();
  }

  place(object, point) {
    object.visible = point !== null;
    if (point) object.position.copy(this.toScene(point));
  }

  drawCandidates(decision) {
    this.drawnDecision = decision;
    empty(this.candidates);
    for (const candidate of decision ? decision.candidates : []) {
      if (!candidate.points || !candidate.points[0].length) continue;
      const { colour, width, dashed } = FATES[candidate.fate];
      const line = this.line(pointsOf(candidate.points), colour, width, { dashed, order: candidate.fate === "chosen" ? 4 : 3 });
      line.userData.fate = candidate.fate;
      this.candidates.add(line);
    }
  }

  /** `shapes`: what jink believes to be in the way. World axes become those of the scene: (x, y, z) to (x, z, -y). */
  drawShapes(shapes) {
    this.drawnShapes = shapes;
    empty(this.shapes);
    for (const shape of shapes) {
      const mesh = new THREE.Mesh(bodyOfShape(shape), solid(COLOURS.believed, BELIEVED[shape.kind === "area" ? "area" : "obstacle"].opacity));
      const [w, x, y, z] = shape.turn;
      mesh.quaternion.set(x, z, -y, w).normalize();
      mesh.userData.shape = shape;
      this.shapes.add(mesh);
    }
  }

  /** Closed areas move. */
  placeShapes(time) {
    for (const mesh of this.shapes.children) {
      const { centre: [x, y, z], velocity, time: known } = mesh.userData.shape;
      mesh.position.copy(this.toScene([x + velocity[0] * (time - known), y + velocity[1] * (time - known), z]));
    }
  }

  /** `paths`: what conflicts are looked for along, or null. One that stays where it is has no line. */
  drawNominal(paths) {
    this.drawnNominal = paths;
    empty(this.nominal);
    for (const { kind, points } of paths || []) {
      if (points.every((column) => column.every((value) => value === column[0]))) continue;
      const { width, dashed } = NOMINAL[kind];
      const line = this.line(pointsOf(points), COLOURS.nominal, width, { dashed, order: 3 });
      line.userData.kind = kind;
      this.nominal.add(line);
    }
  }
}
