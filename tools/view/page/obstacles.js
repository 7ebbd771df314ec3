// The obstacles of the daemon's configuration: translucent solids; a half-space as a plate under the object, with its normal.

import {COLOURS} from './colours.js';
import {facets} from './facets.js';

const OPACITY = 0.3, EDGE_OPACITY = 0.7;
const CREASE = 30;        // deg, angle between faces from which their edge is drawn
const INFINITE = 10;      // m, drawn length of an infinite cylinder
const PLATE = 2.2;        // side of a half-space's plate, of the object's largest extent
const UP = new THREE.Vector3(0, 0, 1);

/** About z, its middle in the origin; `length`: of the segment. */
function capsule(radius, length) {
  const profile = [];
  for (let i = -12; i <= 12; ++i) {
    // The middle twice: at either end of the segment.
    for (const end of i === 0 ? [-0.5, 0.5] : [Math.sign(i) / 2]) {
      const angle = i * Math.PI / 24;
      profile.push(new THREE.Vector2(Math.max(radius * Math.cos(angle), 1e-9), end * length + radius * Math.sin(angle)));
    }
  }
  return new THREE.LatheBufferGeometry(profile, 40).rotateX(Math.PI / 2);
}

function surfaceOf({points, triangles}) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points || []), 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(triangles || []), 1));
  return geometry;
}

/** In the frame of the shape; of a half-space a square of side 1 about the origin. */
function geometryOf(obstacle) {
  const [a, b, c] = obstacle.size;
  switch (obstacle.kind) {
    case 'half_space': return new THREE.PlaneBufferGeometry(1, 1);
    case 'box': return new THREE.BoxBufferGeometry(a, b, c);
    case 'sphere': return new THREE.SphereBufferGeometry(a, 40, 24);
    case 'cylinder': return new THREE.CylinderBufferGeometry(a, a, b || INFINITE, 40, 1, !b).rotateX(Math.PI / 2);
    case 'capsule': return capsule(a, b);
    default: return surfaceOf(obstacle);
  }
}

/** Estimated displacement from the configured pose with its 95 % interval, in each free direction. */
function displacementOf({corrections}) {
  return corrections.map(({axis, unit, displacement, deviation}) =>
    `${displacement < 0 ? '−' : '+'}${Math.abs(displacement).toFixed(1)} ± ${(1.96 * deviation).toFixed(1)} ${unit} ${axis}`).join(', ');
}

/** What is known about the arrival of an obstacle's pose, where that is not self-evident; '' otherwise. */
function arrivalOf({carrier, timeout_ms}, {placed, age_ms}) {
  if (carrier === 'link') return placed ? '' : 'not shown: the joints of the arm are not reported';
  if (carrier !== 'messages') return '';
  if (age_ms === null) return placed ? 'as configured: no message yet' : 'not shown: no message yet';
  return age_ms > timeout_ms ? `no message for ${age_ms < 1e4 ? (age_ms / 1e3).toFixed(1) : Math.round(age_ms / 1e3)} s` : '';
}

/** What the viewer knows about the place of an obstacle, where that is not self-evident; '' otherwise. */
function noteOn(obstacle, place) {
  const arrival = arrivalOf(obstacle, place), displacement = displacementOf(place);
  return [arrival, displacement && `estimated at ${displacement}`].filter(Boolean).join('; ');
}

export class Obstacles {
  constructor(scene) {
    this.scene = scene;
    this.list = [];  // {obstacle, group, surface, note}
    this.around = {mesh: null, middle: new THREE.Vector3(), extent: 1};
  }

  clear() {
    for (const {group} of this.list) {
      this.scene.remove(group);
      group.traverse((part) => {
        if (part.geometry) part.geometry.dispose();
        if (part.material) part.material.dispose();
      });
    }
    this.list = [];
  }

  /** Adds the next one: a parcel `obstacle`. */
  add(obstacle) {
    const geometry = geometryOf(obstacle), isPlate = obstacle.kind === 'half_space', colour = new THREE.Color(COLOURS.obstacle);
    const open = isPlate || (obstacle.kind === 'cylinder' && !obstacle.size[1]);
    const surface = new THREE.Mesh(geometry, facets({
      tint: colour.getHex(), opacity: OPACITY, depthWrite: false, side: open ? THREE.DoubleSide : THREE.FrontSide,
      // Where the object touches it, the object is in front.
      polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4}));
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(geometry, CREASE),
                                         new THREE.LineBasicMaterial({color: colour, transparent: true, opacity: EDGE_OPACITY}));
    surface.renderOrder = edges.renderOrder = 1;
    const group = new THREE.Group();
    group.add(surface, edges);
    for (const at of isPlate ? [0.25, -0.25] : []) group.add(new THREE.ArrowHelper(UP, new THREE.Vector3(at, at, 0), 0.12, colour, 0.04, 0.025));
    group.visible = false;
    this.scene.add(group);
    this.list[obstacle.index] = {obstacle, group, surface, note: ''};
  }

  /** At the places of a frame; plates under `shape` at rest, which has a mesh or not yet. */
  show(frame, shape, shown) {
    this.measure(shape);
    this.list.forEach((one, i) => {
      const place = (frame.obstacles || [])[i], poses = frame.obstacle_poses;
      one.note = place ? noteOn(one.obstacle, place) : '';
      one.group.visible = Boolean(shown && place && place.placed);
      if (!one.group.visible) return;
      one.group.position.fromArray(poses, 7 * i);
      one.group.quaternion.fromArray(poses, 7 * i + 3);
      if (one.obstacle.kind === 'half_space') this.fit(one.group);
    });
  }

  measure({mesh}) {
    if (!mesh || mesh === this.around.mesh) return;
    const box = new THREE.Box3().setFromArray(mesh.rest), size = box.getSize(new THREE.Vector3());
    this.around = {mesh, middle: box.getCenter(new THREE.Vector3()), extent: Math.max(size.x, size.y, size.z)};
  }

  /** A plate to the part of its plane that is nearest to the object. */
  fit(group) {
    const normal = UP.clone().applyQuaternion(group.quaternion), {middle, extent} = this.around;
    const above = normal.dot(middle.clone().sub(group.position));
    group.position.copy(middle).addScaledVector(normal, -above);
    group.scale.setScalar(PLATE * extent);
  }

  /** Name, with its note, of the visible obstacle in front that a ray meets; '' if there is none. */
  nameAt(caster) {
    const visible = this.list.filter(({group}) => group.visible);
    const hit = caster.intersectObjects(visible.map(({surface}) => surface))[0];
    const one = hit && visible.find(({surface}) => surface === hit.object);
    return one ? this.text(one) : '';
  }

  /** Of all, for the key of the picture. */
  texts() { return this.list.map((one) => this.text(one)); }

  text({obstacle, note}) { return note ? `${obstacle.name} (${note})` : obstacle.name; }
}
