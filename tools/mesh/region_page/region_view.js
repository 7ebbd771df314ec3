// The surface of a mesh, each face in the colour of its group.

import {ShapeView} from './shapes.js';

const BARE = 0.6;  // grey of a face of no group

export class RegionView extends ShapeView {
  constructor(scene) { super(scene, {edge: 0x0b1118, edgeOpacity: 0.38, ghost: 0x9fc4e8}); }

  setMesh(mesh) {
    super.setMesh(mesh);
    this.setStyle({ghost: false, plain: false, lines: true});
    // Corners of their own, as neighbouring faces differ in colour; a hit's faceIndex is the face.
    const shared = this.surface.geometry;
    this.surface.geometry = shared.toNonIndexed();
    shared.dispose();
    this.faceColour = this.surface.geometry.getAttribute('color');
  }

  /** A face of several groups is shown by the one called `first`, or by the one with the fewest faces. */
  paint(groups, first) {
    if (!this.mesh) return;
    const out = this.faceColour.array.fill(BARE);
    const order = [...groups].sort((a, b) => (a.name === first) - (b.name === first) || b.outer.length - a.outer.length);
    for (const {outer, colour} of order)
      for (const face of outer)
        for (let corner = 0; corner < 3; ++corner) out.set(colour, 9 * face + 3 * corner);
    this.faceColour.needsUpdate = true;
  }
}
