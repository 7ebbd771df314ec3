// Arrows of forces, and the marks of feature and target.

import {COLOURS, colourOfSource} from './colours.js';

const LENGTH_OF_ONE_NEWTON = 0.03, SHORTEST = 0.012, LONGEST = 0.3;  // m
const BY_HAND = 7;  // contacts_t.source

class Arrow {
  constructor(scene) {
    const material = this.material = new THREE.MeshLambertMaterial({transparent: true, depthTest: false});
    this.shaft = new THREE.Mesh(new THREE.CylinderBufferGeometry(1, 1, 1, 12).translate(0, 0.5, 0), material);
    this.head = new THREE.Mesh(new THREE.ConeBufferGeometry(1, 1, 16).translate(0, -0.5, 0), material);
    this.group = new THREE.Group();
    this.group.add(this.shaft, this.head);
    // Visible through the object, since many forces act inside it.
    this.shaft.renderOrder = 5;
    this.head.renderOrder = 6;
    scene.add(this.group);
  }

  /** An arrow of `force` (N), ending at `at` if `into`, otherwise starting there. */
  set(at, force, colour, {into = true, thick = 1, opacity = 1} = {}) {
    const f = new THREE.Vector3(...force), size = f.length();
    this.group.visible = size > 1e-3;
    if (!this.group.visible) return;
    const length = Math.min(Math.max(size * LENGTH_OF_ONE_NEWTON, SHORTEST), LONGEST);
    const head = Math.min(0.45 * length, 0.02 * thick), radius = 0.0032 * thick;
    this.shaft.scale.set(radius, length - head, radius);
    this.head.scale.set(2.6 * radius, head, 2.6 * radius);
    this.head.position.y = length;
    f.divideScalar(size);
    this.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), f);
    this.group.position.fromArray(at);
    if (into) this.group.position.addScaledVector(f, -length);
    this.material.color.set(colour);
    this.material.emissive.set(colour).multiplyScalar(0.25);
    this.material.opacity = opacity;
  }
}

export class Arrows {
  constructor(scene) {
    this.scene = scene;
    this.arrows = [];
  }

  begin() { this.used = 0; }

  add(...of) {
    if (this.used === this.arrows.length) this.arrows.push(new Arrow(this.scene));
    this.arrows[this.used++].set(...of);
  }

  end() {
    for (let i = this.used; i < this.arrows.length; ++i) this.arrows[i].group.visible = false;
  }

  /** All forces of a frame; `pushes`: [{at, force}], manual forces, whose messages refer to the rest shape. */
  show(frame, pushes, shown) {
    this.begin();
    if (shown) {
      for (const contact of frame.contacts || [])
        if (contact.source !== BY_HAND) this.add(contact.at, contact.wrench, colourOfSource(contact.source));
      for (const contact of frame.predicted ? frame.predicted.points : [])
        this.add(contact.at, contact.force, COLOURS.predicted, {thick: 0.6});
      const estimate = frame.estimate;
      if (estimate) {
        for (const grasp of estimate.grasps)
          this.add(grasp.at, grasp.wrench, COLOURS.reaction, {thick: 0.75, opacity: 0.85});
        if (estimate.unknown_deviation >= 0 && estimate.unknown_force)
          this.add(estimate.unknown_at, estimate.unknown_force, COLOURS.unknown);
      }
      for (const grasp of frame.truth_contacts || [])
        this.add(grasp.at, grasp.wrench, COLOURS.truthForce, {thick: 0.5, opacity: 0.8});
    }
    for (const {at, force} of pushes) this.add(at, force, COLOURS.push, {into: false, thick: 1.3});
    this.end();
  }
}

/** Positions of feature and target, as points of O: for kinds that have a position. */
export function placesOf(kind, values) {
  if (!values) return [];
  if (kind === 'point' && values.length >= 3) return [values.slice(0, 3)];
  if (kind === 'pose' && values.length >= 7) return [values.slice(0, 3)];
  if (kind !== 'points') return [];
  const places = [];
  for (let i = 0; i + 2 < values.length; i += 3) places.push(values.slice(i, i + 3));
  return places;
}

export class FeatureMarks {
  constructor(scene) {
    this.group = new THREE.Group();
    scene.add(this.group);
    this.ball = new THREE.SphereBufferGeometry(1, 24, 16);
    this.marks = [];
    this.lineGeometry = new THREE.BufferGeometry();
    this.lineGeometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(6 * 32), 3));
    this.line = new THREE.LineSegments(this.lineGeometry, new THREE.LineBasicMaterial({color: COLOURS.target}));
    this.line.frustumCulled = false;
    this.axes = [new THREE.AxesHelper(0.015), new THREE.AxesHelper(0.015)];
    this.group.add(this.line, ...this.axes);
  }

  mark(index) {
    while (this.marks.length <= index) {
      const mesh = new THREE.Mesh(this.ball, new THREE.MeshLambertMaterial({transparent: true}));
      mesh.renderOrder = 4;
      this.marks.push(mesh);
      this.group.add(mesh);
    }
    return this.marks[index];
  }

  /** `dragged`: current values of a target that is being dragged. */
  show(feature, dragged, shown, size) {
    let used = 0;
    const target = dragged || (feature && feature.revision >= 0 ? feature.target : null);
    const from = feature ? placesOf(feature.kind, feature.value) : [];
    const to = feature && target ? placesOf(feature.kind, target) : [];
    const put = (places, colour, radius, opacity) => {
      for (const place of shown ? places : []) {
        const mark = this.mark(used++);
        mark.visible = true;
        mark.position.fromArray(place);
        mark.scale.setScalar(radius);
        mark.material.color.set(colour);
        mark.material.emissive.set(colour).multiplyScalar(0.35);
        mark.material.opacity = opacity;
      }
    };
    const small = from.length > 4 ? 0.55 : 1;
    put(from, COLOURS.feature, 0.011 * size * small, 1);
    put(to, COLOURS.target, 0.018 * size * small, 0.5);
    for (let i = used; i < this.marks.length; ++i) this.marks[i].visible = false;
    const pairs = shown ? Math.min(from.length, to.length, 32) : 0, xyz = this.lineGeometry.attributes.position;
    for (let i = 0; i < pairs; ++i) {
      xyz.array.set(from[i], 6 * i);
      xyz.array.set(to[i], 6 * i + 3);
    }
    xyz.needsUpdate = true;
    this.lineGeometry.setDrawRange(0, 2 * pairs);
    const isPose = shown && feature && feature.kind === 'pose';
    [feature && feature.value, target].forEach((values, i) => {
      this.axes[i].visible = Boolean(isPose && values && values.length >= 7);
      if (!this.axes[i].visible) return;
      this.axes[i].position.fromArray(values);
      this.axes[i].quaternion.set(values[4], values[5], values[6], values[3]);
      this.axes[i].scale.setScalar(4 * size);
    });
  }
}
