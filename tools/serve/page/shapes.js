// The estimated and the true shape: surfaces coloured by a number per node, mesh lines, nodes.

import {COLOURS, colourOf} from './colours.js';
import {facets} from './facets.js';

const MOST_LINES = 5000;
const CREASE = Math.cos(30 * Math.PI / 180);

/**
 * Pairs of nodes: all edges of the surface's elements, and those with a sharp angle at rest. Between the `middles` of
 * edges the triangles of one face meet.
 */
function edgesOf({triangles, rest, middles}) {
  const normals = [], seen = new Map(), edges = [], middle = new Set(middles);
  const corner = (n) => new THREE.Vector3().fromArray(rest, 3 * n);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => corner(triangles[t + k]));
    normals.push(b.sub(a).cross(c.sub(a)).normalize());
    for (let e = 0; e < 3; ++e) {
      const i = triangles[t + e], j = triangles[t + (e + 1) % 3];
      if (middle.has(i) && middle.has(j)) continue;
      const key = Math.min(i, j) * 2097152 + Math.max(i, j), known = seen.get(key);
      if (known) {
        known.crease = normals[known.triangle].dot(normals[t / 3]) < CREASE;
      } else {
        const edge = {i, j, triangle: t / 3, crease: true};
        seen.set(key, edge);
        edges.push(edge);
      }
    }
  }
  const pairs = (list) => new THREE.BufferAttribute(new Uint32Array(list.flatMap(({i, j}) => [i, j])), 1);
  return {all: pairs(edges), creases: pairs(edges.filter((edge) => edge.crease))};
}

/** Whether two lists, or none, hold the same numbers. */
function same(a, b) {
  if (!a || !b) return !a && !b;
  return a.length === b.length && a.every((value, i) => value === b[i]);
}

export class ShapeView {
  constructor(scene, style) {
    this.style = style;
    this.group = new THREE.Group();
    scene.add(this.group);
    this.mesh = null;
    this.surfaceNodes = [];
    this.values = null;
  }

  /** Sets another mesh: {hash, rest, triangles, constrained, middles}. */
  setMesh(mesh) {
    for (const child of [...this.group.children]) {
      this.group.remove(child);
      child.geometry.dispose();
      child.material.dispose();
    }
    this.mesh = mesh;
    const count = mesh.rest.length / 3;
    this.position = new THREE.BufferAttribute(new Float32Array(mesh.rest), 3);
    this.colour = new THREE.BufferAttribute(new Float32Array(3 * count).fill(0.6), 3);
    this.surfaceNodes = [...new Set(mesh.triangles)].sort((a, b) => a - b);

    const surface = new THREE.BufferGeometry();
    surface.setAttribute('position', this.position);
    surface.setAttribute('color', this.colour);
    surface.setIndex(new THREE.BufferAttribute(new Uint32Array(mesh.triangles), 1));
    this.surface = new THREE.Mesh(surface, null);
    const lines = new THREE.BufferGeometry();
    lines.setAttribute('position', this.position);
    this.lines = edgesOf(mesh);
    lines.setIndex(this.lines.all);
    this.edges = new THREE.LineSegments(lines, new THREE.LineBasicMaterial(
        {color: this.style.edge, transparent: true, opacity: this.style.edgeOpacity}));
    const nodes = new THREE.BufferGeometry();
    nodes.setAttribute('position', this.position);
    this.nodeColour = new THREE.BufferAttribute(new Float32Array(3 * count), 3);
    nodes.setAttribute('color', this.nodeColour);
    nodes.setIndex(new THREE.BufferAttribute(new Uint32Array(this.surfaceNodes), 1));
    this.nodes = new THREE.Points(nodes, new THREE.PointsMaterial(
        {size: 5, sizeAttenuation: false, vertexColors: THREE.VertexColors}));
    this.nodes.visible = false;
    for (const part of [this.surface, this.edges, this.nodes]) {
      part.frustumCulled = false;
      this.group.add(part);
    }
    this.styled = '';
    this.painted = false;
    this.setStyle({ghost: false, plain: false, lines: this.isCoarse()});
    this.markNodes(new Set());
  }

  /** `lines`: all of the mesh's, otherwise those of its creases. */
  setStyle({ghost, plain, lines}) {
    const style = `${ghost} ${plain} ${lines}`;
    if (!this.mesh || (this.surface.material && this.styled === style)) return;
    this.styled = style;
    if (this.surface.material) this.surface.material.dispose();
    const common = {side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1};
    // Where both shapes coincide, the estimate is in front.
    const behind = {polygonOffsetFactor: 3, polygonOffsetUnits: 12};
    if (ghost) {
      this.surface.material = facets({...common, ...behind, tint: this.style.ghost, opacity: 0.1, depthWrite: false});
    } else if (plain) {
      this.surface.material = new THREE.MeshBasicMaterial({...common, vertexColors: THREE.VertexColors});
    } else {
      this.surface.material = facets(common);
    }
    this.surface.renderOrder = ghost ? 2 : 0;
    this.edges.geometry.setIndex(lines && !ghost ? this.lines.all : this.lines.creases);
    this.edges.material.color.set(ghost ? this.style.ghost : this.style.edge);
    this.edges.material.opacity = ghost ? 0.9 : this.style.edgeOpacity;
    this.edges.visible = ghost || !plain;
  }

  /** Whether lines leave enough of the colours between them visible, and are cheap. */
  isCoarse() { return this.lines.all.count < 2 * MOST_LINES; }

  /** Takes over the array. Largest change of a coordinate, m; nothing is redrawn if it is zero. */
  setPositions(xyz) {
    const old = this.position.array;
    let farthest = 0;
    for (let i = 0; i < xyz.length; ++i) farthest = Math.max(farthest, Math.abs(xyz[i] - old[i]));
    if (farthest === 0) return 0;
    this.position.array = xyz;
    this.position.needsUpdate = true;
    return farthest;
  }

  /** Colours by `values` (SI), with `most` as the top; none: grey. Returns whether they have changed. */
  paint(values, most) {
    const {values: old, most: oldMost} = this;
    this.values = values;
    this.most = most;
    if (this.painted && most === oldMost && same(values, old)) return false;
    const out = this.colour.array;
    if (!values) out.fill(0.6);
    else for (let n = 0; n < values.length; ++n) colourOf(values[n] / most, out, 3 * n);
    this.colour.needsUpdate = this.painted = true;
    return true;
  }

  /** As in the thesis' Fig. 4.4: white nodes, green loaded ones, red constrained ones. */
  markNodes(loaded) {
    const held = new Set(this.mesh.constrained), colour = new THREE.Color();
    for (let n = 0; n < this.nodeColour.count; ++n) {
      colour.set(loaded.has(n) ? COLOURS.loaded : held.has(n) ? COLOURS.constrained : COLOURS.node);
      colour.toArray(this.nodeColour.array, 3 * n);
    }
    this.nodeColour.needsUpdate = true;
  }

  node(n, out = new THREE.Vector3()) { return out.fromArray(this.position.array, 3 * n); }

  /** Largest distance of the surface's nodes from their centre, and that centre. */
  bounds() {
    const box = new THREE.Box3(), p = new THREE.Vector3();
    for (const n of this.surfaceNodes) box.expandByPoint(this.node(n, p));
    return box;
  }

  nearestNode(point) { return this.nearest(point, this.position.array); }
  nearestAtRest(at) { return this.nearest(new THREE.Vector3(...at), this.mesh.rest); }

  /** Of the surface's nodes at positions `xyz`. */
  nearest(point, xyz) {
    let best = -1, least = Infinity;
    const p = new THREE.Vector3();
    for (const n of this.surfaceNodes) {
      const d = p.fromArray(xyz, 3 * n).distanceToSquared(point);
      if (d < least) { least = d; best = n; }
    }
    return best;
  }
}
