// Actions of the pointer on the stage: rotate and select, apply a force to a node, drag the target, name an obstacle.

import {placesOf} from './arrows.js';
import {FIELDS} from './colours.js';

const byId = (id) => document.getElementById(id);
const REACH = 26;          // px, within which a node or a target is selected
const RENEW = 40;          // ms between two force messages; the daemon drops one after 100
const STILL = 5;           // px, a press that has moved no farther is a click

export class Pointer {
  /** `world`: {stage, shape, obstacles, control, send, frame}; the last returns the current frame. */
  constructor(world) {
    this.world = world;
    this.mode = 'look';
    this.picked = -1;
    this.pull = null;     // {node, force, at}
    this.dragged = null;  // values of a target in transit
    for (const button of document.querySelectorAll('#pointer button')) button.onclick = () => this.setMode(button.dataset.mode);
    const canvas = world.stage.canvas;
    canvas.addEventListener('pointerdown', (event) => this.press(event), true);
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerleave', () => this.nameObstacle(null));
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => this.release(event));
    setInterval(() => this.renew(), RENEW);
  }

  setMode(mode) {
    this.mode = mode;
    for (const button of document.querySelectorAll('#pointer button')) button.classList.toggle('on', button.dataset.mode === mode);
    this.hint({look: '', push: 'Press on a node and pull.', target: 'Drag the red target, or the green feature for a new one.'}[mode]);
  }

  hint(text) {
    byId('hint').textContent = text;
    byId('hint').hidden = !text;
  }

  place(event) {
    const box = this.world.stage.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** The node of the estimate in front that is nearest to a pixel, -1 if none is near. */
  nodeAt(x, y) {
    const {stage, shape} = this.world;
    if (!shape.mesh) return -1;
    shape.surface.geometry.computeBoundingSphere();
    const hit = stage.ray(x, y).intersectObject(shape.surface)[0];
    const candidates = hit ? [hit.face.a, hit.face.b, hit.face.c] : shape.surfaceNodes;
    let best = -1, least = hit ? Infinity : REACH;
    for (const n of candidates) {
      const p = stage.toScreen(shape.node(n)), d = Math.hypot(p.x - x, p.y - y);
      if (d < least) { least = d; best = n; }
    }
    return best;
  }

  press(event) {
    if (event.button !== 0) return;
    const [x, y] = this.place(event);
    this.pressed = {x, y};
    if (this.mode === 'push') this.beginPush(x, y);
    if (this.mode === 'target') this.beginTarget(x, y);
    if (!this.pull && !this.drag) return;
    // Before the event reaches the camera's controls.
    this.world.stage.controls.enabled = false;
    this.world.stage.canvas.setPointerCapture(event.pointerId);
    event.preventDefault();
  }

  beginPush(x, y) {
    const node = this.nodeAt(x, y);
    if (node < 0) return;
    this.pick(node);
    this.pull = {node, x, y, force: [0, 0, 0], at: [0, 0, 0]};
    this.updatePull();
  }

  beginTarget(x, y) {
    const {stage, frame} = this.world, feature = frame() && frame().feature;
    if (!feature) return;
    const near = (values) => placesOf(feature.kind, values).find((place) => {
      const p = stage.toScreen(new THREE.Vector3(...place));
      return Math.hypot(p.x - x, p.y - y) < REACH;
    });
    const target = feature.revision >= 0 ? feature.target : null;
    const place = (target && near(target)) || near(feature.value);
    if (!place) {
      if (!placesOf(feature.kind, feature.value).length) this.hint(`A target of kind ${feature.kind} has no place: palpate-command target sets it.`);
      return;
    }
    const values = target && near(target) ? target : feature.value;
    const from = new THREE.Vector3(...place);
    this.drag = {kind: feature.kind, values: [...values], place: from, grip: stage.onPlane(x, y, from)};
  }

  /** At the pointer, while no button is pressed. */
  nameObstacle(event) {
    const {stage, obstacles} = this.world, box = byId('hovered'), [x, y] = event ? this.place(event) : [0, 0];
    const name = event && !event.buttons && obstacles.list.length ? obstacles.nameAt(stage.ray(x, y)) : '';
    box.hidden = !name;
    box.textContent = name;
    box.style.left = `${x + 14}px`;
    box.style.top = `${y + 10}px`;
  }

  move(event) {
    const [x, y] = this.place(event);
    this.nameObstacle(event);
    if (this.pull) {
      Object.assign(this.pull, {x, y});
      this.updatePull();
    } else if (this.drag) {
      const at = this.world.stage.onPlane(x, y, this.drag.place);
      if (!at) return;
      const shift = at.sub(this.drag.grip).toArray();
      const count = this.drag.kind === 'pose' ? 3 : this.drag.values.length;
      this.dragged = this.drag.values.map((v, i) => i < count ? v + shift[i % 3] : v);
      this.hint(`Target moves by ${(1e3 * Math.hypot(...shift)).toFixed(1)} mm`);
      this.world.stage.dirty = true;
    }
  }

  /** The node moves meanwhile: the force is that of a spring from it to the pointer. */
  updatePull() {
    const {stage, shape, control, maxForce} = this.world;
    const at = shape.node(this.pull.node), to = stage.onPlane(this.pull.x, this.pull.y, at);
    const force = to ? to.sub(at).multiplyScalar(control.strength) : new THREE.Vector3();
    if (force.length() > maxForce()) force.setLength(maxForce());
    this.pull.force = force.toArray();
    this.pull.at = at.toArray();
    this.hint(`Pushing node ${this.pull.node} with ${force.length().toFixed(2)} N`);
    stage.dirty = true;
  }

  renew() {
    if (!this.pull) return;
    this.updatePull();
    this.sendPull(this.pull.force);
  }

  sendPull(force) {
    const rest = this.world.shape.mesh.rest, n = this.pull.node;
    this.world.send({type: 'push', point: [...rest.slice(3 * n, 3 * n + 3)], force});
  }

  release(event) {
    const {stage, control} = this.world, [x, y] = this.place(event);
    if (this.pull) {
      this.sendPull([0, 0, 0]);
      this.pull = null;
      this.setMode('push');
    } else if (this.drag) {
      if (this.dragged) control.ask({type: 'target', kind: this.drag.kind, values: this.dragged}, `target ${this.drag.kind}`);
      this.drag = null;
      // Shown until the daemon's own replaces it.
      setTimeout(() => { this.dragged = null; stage.dirty = true; }, 400);
      this.setMode('target');
    } else if (this.pressed && Math.hypot(x - this.pressed.x, y - this.pressed.y) < STILL) {
      this.pick(this.nodeAt(x, y));
    }
    this.pressed = null;
    stage.controls.enabled = true;
    stage.dirty = true;
  }

  pick(node) {
    this.picked = node;
    this.showPicked();
  }

  showPicked() {
    const {shape, frame} = this.world, box = byId('picked');
    const there = this.picked >= 0 && shape.mesh && this.picked < shape.mesh.rest.length / 3;
    box.hidden = !there;
    if (!there) return;
    const rest = new THREE.Vector3().fromArray(shape.mesh.rest, 3 * this.picked), now = shape.node(this.picked);
    const mm = (v) => v.toArray().map((c) => (1e3 * c).toFixed(1)).join('  ');
    let text = `Node ${this.picked}\nat rest  ${mm(rest)} mm\nmoved  ${mm(now.sub(rest))} mm`;
    const field = frame() && FIELDS[frame().field];
    if (field && shape.values) text += `\n${field.title.toLowerCase()}  ${(shape.values[this.picked] * field.factor).toFixed(2)} ${field.unit}`;
    if (box.textContent !== text) box.textContent = text;
  }
}
