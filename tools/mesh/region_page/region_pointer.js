// Actions of the pointer on the mesh: a brush, the side that was clicked, a rectangle.

const byId = (id) => document.getElementById(id);
const EVERY = 30;  // ms between two strokes of a moved brush
const HINTS = {
  look: '', brush: 'Draw on the mesh; elsewhere the view turns.', connected: 'Click a side.',
  rectangle: 'Draw a rectangle: faces turned to you that lie in it.',
};

export class RegionPointer {
  /** `world`: {stage, view, select, radius, angle}. */
  constructor(world) {
    this.world = world;
    this.mode = 'look';
    this.chosenEdit = 'add';
    this.stroke = Date.now();  // number of the stroke that is drawn
    this.painting = false;
    this.from = null;          // corner of a rectangle
    this.painted = 0;
    for (const button of document.querySelectorAll('#pointer button')) button.onclick = () => this.setMode(button.dataset.mode);
    for (const button of document.querySelectorAll('#edit button')) button.onclick = () => this.setEdit(button.dataset.edit);
    this.ring = new THREE.Mesh(new THREE.SphereBufferGeometry(1, 24, 16),
        new THREE.MeshBasicMaterial({color: 0x4cc2ff, transparent: true, opacity: 0.22, depthWrite: false}));
    this.ring.visible = false;
    world.stage.scene.add(this.ring);
    const canvas = world.stage.canvas;
    canvas.addEventListener('pointerdown', (event) => this.press(event), true);
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerleave', () => this.showRing(null));
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => this.release(event));
  }

  setMode(mode) {
    this.mode = mode;
    for (const button of document.querySelectorAll('#pointer button')) button.classList.toggle('on', button.dataset.mode === mode);
    byId('hint').textContent = HINTS[mode];
    byId('hint').hidden = !HINTS[mode];
    this.showRing(null);
  }

  setEdit(edit) {
    this.chosenEdit = edit;
    for (const button of document.querySelectorAll('#edit button')) button.classList.toggle('on', button.dataset.edit === edit);
  }

  get edit() { return this.shift ? 'remove' : this.chosenEdit; }

  place(event) {
    const box = this.world.stage.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** The face in front at a pixel, and the place on it; null outside the mesh. */
  hit(x, y) {
    const {stage, view} = this.world;
    if (!view.mesh) return null;
    return stage.ray(x, y).intersectObject(view.surface)[0] || null;
  }

  press(event) {
    if (event.button !== 0 || this.mode === 'look') return;
    const [x, y] = this.place(event), hit = this.hit(x, y);
    this.shift = event.shiftKey;
    if (this.mode === 'rectangle') this.from = [x, y];
    else if (!hit) return;  // turns the view
    ++this.stroke;
    if (this.mode === 'brush') {
      this.painting = true;
      this.paint(hit);
    }
    if (this.mode === 'connected') this.world.select({by: 'connected', face: hit.faceIndex, angle: this.world.angle()}, this.edit);
    // Before the event reaches the camera's controls.
    this.world.stage.controls.enabled = false;
    this.world.stage.canvas.setPointerCapture(event.pointerId);
    event.preventDefault();
  }

  paint(hit) {
    this.painted = performance.now();
    const {select, radius, angle} = this.world;
    select({by: 'brush', face: hit.faceIndex, at: hit.point.toArray(), radius: radius(), angle: angle()}, this.edit, this.stroke);
  }

  move(event) {
    const [x, y] = this.place(event);
    if (this.from) return this.showRectangle(x, y);
    if (this.mode !== 'brush') return;
    const hit = this.hit(x, y);
    this.showRing(hit);
    if (this.painting && hit && performance.now() - this.painted >= EVERY) this.paint(hit);
  }

  showRing(hit) {
    const was = this.ring.visible;
    this.ring.visible = Boolean(hit) && this.mode === 'brush';
    if (this.ring.visible) {
      this.ring.position.copy(hit.point);
      this.ring.scale.setScalar(this.world.radius());
    }
    if (was || this.ring.visible) this.world.stage.dirty = true;
  }

  showRectangle(x, y) {
    const style = byId('rectangle').style, [left, top] = this.from;
    byId('rectangle').hidden = false;
    style.left = `${Math.min(left, x)}px`;
    style.top = `${Math.min(top, y)}px`;
    style.width = `${Math.abs(x - left)}px`;
    style.height = `${Math.abs(y - top)}px`;
  }

  release(event) {
    const {stage} = this.world;
    if (this.from && event.type === 'pointerup') this.selectRectangle(...this.from, ...this.place(event));
    this.from = null;
    this.painting = false;
    this.shift = false;
    byId('rectangle').hidden = true;
    stage.controls.enabled = true;
  }

  selectRectangle(x0, y0, x1, y1) {
    const {stage, select} = this.world, {camera, canvas} = stage;
    camera.updateMatrixWorld();
    const clip = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const across = (x) => 2 * x / canvas.clientWidth - 1, up = (y) => 1 - 2 * y / canvas.clientHeight;
    select({by: 'rectangle', clip_from_object: [...clip.elements],
      lower: [across(Math.min(x0, x1)), up(Math.max(y0, y1))], upper: [across(Math.max(x0, x1)), up(Math.min(y0, y1))]}, this.edit);
  }
}
