// Assembles the page: data from palpate-view to the stage and the panels.

import {Arrows, FeatureMarks, placesOf} from './arrows.js';
import {COLOURS, FIELDS} from './colours.js';
import {Consistency} from './consistency.js';
import {Control} from './control.js';
import {Fingertips} from './fingertips.js';
import {Legend} from './legend.js';
import {Link, takeToken} from './link.js';
import {Obstacles} from './obstacles.js';
import {Pace} from './pace.js';
import {Panels, fixed, unitOf} from './panels.js';
import {Plot} from './plot.js';
import {Pointer} from './pointer.js';
import {ShapeView} from './shapes.js';
import {Stage} from './stage.js';
import {Timeline} from './timeline.js';

const SEEN = 3e-4;  // relative to the object's size: motion that is visible
const byId = (id) => document.getElementById(id);
const token = takeToken();

const stage = new Stage(byId('canvas'));
const estimate = new ShapeView(stage.scene, {edge: 0x0b1118, edgeOpacity: 0.38, ghost: 0x9fc4e8});
const truth = new ShapeView(stage.scene, {edge: 0x0b1118, edgeOpacity: 0.38, ghost: new THREE.Color(COLOURS.truth).getHex()});
const arrows = new Arrows(stage.scene);
const marks = new FeatureMarks(stage.scene);
const obstacles = new Obstacles(stage.scene);
const seen = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({color: COLOURS.seen, size: 4, sizeAttenuation: false}));
seen.frustumCulled = false;
stage.scene.add(seen);
const chosen = new THREE.Mesh(new THREE.SphereBufferGeometry(1, 20, 14), new THREE.MeshBasicMaterial({color: 0xffffff, transparent: true, opacity: 0.9}));
chosen.visible = false;
stage.scene.add(chosen);

const layers = {estimate: true, truth: true, robot: true, forces: true, feature: true, obstacles: true, nodes: false, lines: true, plain: false};
const legend = new Legend();
const panels = new Panels();
const fingertips = new Fingertips();
const consistency = new Consistency();
const errorPlot = new Plot(byId('error-plot'), [{name: 'error', colour: '#ff8f8f'}], {unit: 'mm'});
const shapePlot = new Plot(byId('shape-error-plot'), [
  {name: 'mean', colour: '#4cc2ff'}, {name: 'RMS', colour: '#f0b440'}, {name: 'largest', colour: '#ff8f8f'}], {unit: 'mm'});
const latencyPlot = new Plot(byId('latency-plot'), [
  {name: 'cycle', colour: '#4cc2ff'}, {name: 'wake-up', colour: '#f0b440'}, {name: 'shape to view', colour: '#b28cff'}], {decades: [0, 6]});
let frame = null, drawn = null, health = null, connected = false, greeting = null, size = 1;

const send = (message) => link.send(message);
const control = new Control(send);
const timeline = new Timeline(send);
const pointer = new Pointer({stage, shape: estimate, obstacles, control, send, frame: () => frame, maxForce: () => greeting ? greeting.max_force : 0});

const link = new Link({
  open() {
    connected = true;
    estimate.known = truth.known = null;
    send({type: 'colour', field: byId('field').value});
    if (token) send({type: 'control', token});
  },
  close() {
    connected = false;
    control.setGranted(false, '');
    control.fail('the connection to palpate-view has ended');
    pointer.pull = pointer.drag = pointer.dragged = null;
    stage.controls.enabled = true;
    panels.showState(frame || {}, health, false);
  },
  hello(message) {
    greeting = message;
    frame = health = null;  // of the previous content
    control.setHello(message);
    fingertips.setHello(message);
    timeline.setLog(message.log || null);
    stage.setBase(message.base);
    stage.setRobots(message.robots);
    obstacles.clear();
    setButtonOfObstacles();
    stage.dirty = true;
    byId('source').textContent = message.mode === 'log' ? 'recording' : '';
    beginPlots(message);
  },
  control({granted, reason}) {
    if (!granted && reason === 'wrong token') sessionStorage.removeItem('token');
    control.setGranted(granted, reason);
  },
  obstacle(message) {
    obstacles.add(message);
    setButtonOfObstacles();
    stage.dirty = true;
  },
  mesh(mesh) {
    const shape = mesh.role === 'truth' ? truth : estimate;
    const other = shape.mesh && shape.mesh.hash !== mesh.hash;
    if (!shape.mesh || other) shape.setMesh(mesh);
    shape.known = mesh.hash;
    stage.dirty = true;
    if (shape === estimate && (other || !greeting.shown)) setLayer('lines', estimate.isCoarse());
    greeting.shown = true;
    if (other && shape === estimate) pointer.pick(-1);
  },
  events(message) {
    panels.addEvents(message);
    message.events.forEach((event) => control.note(event));
  },
  messages(message) { panels.showMessages(message); },
  answer(message) { control.answer(message); },
  error({reason}) { byId('reason').textContent = reason; },
  frame(message) {
    frame = message;
    if (message.health) health = message.health;
  },
});

function beginPlots(message) {
  errorPlot.clear();
  latencyPlot.clear();
  shapePlot.clear();
  consistency.begin(message);
  if (message.log) {
    const {series, duration} = message.log, scale = (s, f) => ({time: s.time, value: s.value.map((v) => v * f)});
    errorPlot.scaled = null;
    errorPlot.raw = series[0];
    errorPlot.fix(duration, [scale(series[0], 1e3)]);
    latencyPlot.fix(duration, [scale(series[1], 1), scale(series[2], 1), {time: [], value: []}]);
    latencyPlot.lines.length = 2;
    return;
  }
  const {time, error, cycle, wake_up, view} = message.history, now = performance.now() / 1e3;
  time.forEach((t, i) => {
    errorPlot.add(now + t, [error[i] === null ? NaN : error[i] * 1e3]);
    latencyPlot.add(now + t, [cycle[i], wake_up[i], view[i] === null ? NaN : view[i] * 1e3]);
  });
}

function plot() {
  const now = performance.now() / 1e3, {feature, shape, player} = frame;
  const {factor, unit, digits} = unitOf(feature ? feature.kind : '');
  const error = feature && feature.revision >= 0 ? Math.hypot(...feature.error) * factor : NaN;
  errorPlot.unit = unit;
  if (player && errorPlot.raw && errorPlot.scaled !== factor) {
    errorPlot.scaled = factor;
    errorPlot.lines[0].value = errorPlot.raw.value.map((v) => v * factor);
  }
  if (!player) {
    errorPlot.add(now, [error]);
    latencyPlot.add(now, [health ? health.p99_us[0] : NaN, health ? health.p99_us[9] : NaN, shape ? shape.delay_ms * 1e3 : NaN]);
  }
  plotShapeError(player ? player.time : now);
  consistency.show(frame, player ? player.time : now, panels.tab === 'plots');
  byId('error-now').textContent = Number.isFinite(error) ? `${fixed(error, digits)} ${unit}` : 'no target';
  byId('latency-now').textContent = health ? `${fixed(health.p99_us[0], 0)} \u00b5s` : '';
  if (panels.tab !== 'plots') return;
  errorPlot.draw(player ? player.time : now);
  latencyPlot.draw(player ? player.time : now);
}

/** Distances of the estimate from the true shape, where there is one; of a log as far as it has been played. */
function plotShapeError(time) {
  const error = frame.shape_error, values = error ? [error.mean, error.rms, error.largest].map((x) => 1e3 * x) : [];
  byId('shape-error').hidden = !error;
  if (!error) return;
  if (time < shapePlot.lines[0].time[shapePlot.lines[0].time.length - 1]) shapePlot.clear();
  shapePlot.add(time, values);
  byId('shape-error-now').textContent = `${values.map((x) => fixed(x, 2)).join(', ')} mm${error.by_arrival ? ', clocks differ' : ''}`;
  if (panels.tab === 'plots') shapePlot.draw(time);
}

function setLayer(name, on) {
  layers[name] = on;
  document.querySelector(`#layers [data-layer=${name}]`).classList.toggle('on', on);
  stage.dirty = true;
}

function setButtonOfObstacles() { document.querySelector('#layers [data-layer=obstacles]').hidden = !obstacles.list.length; }

/** Largest value of the visible nodes. */
function largest(values, shape) {
  let most = 0;
  for (const n of shape.surfaceNodes) if (values[n] > most) most = values[n];
  return most;
}

function showShapes() {
  const hasEstimate = Boolean(frame.x && estimate.mesh && frame.mesh === estimate.mesh.hash);
  const hasTruth = Boolean(frame.truth_x && truth.mesh && frame.truth_mesh === truth.mesh.hash);
  estimate.group.visible = hasEstimate && layers.estimate;
  truth.group.visible = hasTruth && layers.truth;
  const went = Math.max(hasEstimate ? estimate.setPositions(frame.x) : 0, hasTruth ? truth.setPositions(frame.truth_x) : 0);
  if (went > 0) stage.dirty = true;
  if (went > SEEN * size) pace.moved(performance.now());
  // Alone, the true shape is coloured; together with the estimate it is translucent.
  const coloured = layers.estimate || !hasTruth ? 'estimate' : 'truth';
  const [shape, values] = coloured === 'estimate' ? [estimate, frame.values] : [truth, frame.truth_values];
  if (hasEstimate) estimate.setStyle({ghost: false, plain: layers.plain, lines: layers.lines});
  if (hasTruth) truth.setStyle({ghost: coloured === 'estimate', plain: layers.plain, lines: layers.lines});
  const field = frame.field;
  const top = legend.top(field, values && shape.mesh ? largest(values, shape) : 0);
  if ((coloured === 'estimate' ? hasEstimate : hasTruth) && shape.paint(values, top)) stage.dirty = true;
  legend.show(field, top, values ? (coloured === 'estimate' ? '' : 'of the true shape') : noteWithout(field, coloured));
  if (estimate.nodes) {
    estimate.nodes.visible = layers.nodes;
    if (layers.nodes) estimate.markNodes(new Set((frame.contacts || []).map(
        (c) => c.source === 7 ? estimate.nearestAtRest(c.at) : estimate.nearestNode(new THREE.Vector3(...c.at)))));
  }
  if (truth.nodes) truth.nodes.visible = false;
  byId('waiting').hidden = hasEstimate || hasTruth;
  byId('waiting-why').textContent = frame.x || frame.truth_x || frame.shape ? 'its mesh has not been received yet' : 'no message on SHAPE';
  if ((hasEstimate || hasTruth) && !stage.framed) frameObject();
  return hasEstimate;
}

function noteWithout(field, coloured) {
  if (coloured === 'truth') return 'not known of the true shape';
  if (field === 'uncertainty') return 'the estimator reports none (pose_wrench_filter does)';
  return 'not known';
}

function frameObject() {
  const shape = estimate.group.visible || !truth.mesh ? estimate : truth;
  if (!shape.mesh) return;
  const box = shape.bounds();
  size = Math.min(Math.max(box.getSize(new THREE.Vector3()).length() / 0.6, 0.15), 4);
  stage.frame(box);
}

function showKey() {
  const parts = [];
  if (layers.estimate && frame.x) parts.push(['linear-gradient(90deg,#440154,#21918c,#fde725)', 'estimate']);
  if (layers.truth && frame.truth_x) parts.push([COLOURS.truth, 'true shape']);
  if (layers.forces && (frame.contacts || []).length) parts.push(['#4cc2ff', 'measured force, 1 N = 30 mm']);
  if (layers.forces && frame.predicted && frame.predicted.points.length) parts.push([COLOURS.predicted, 'predicted contact']);
  if (layers.obstacles && obstacles.list.length) parts.push([COLOURS.obstacle, `obstacles: ${obstacles.texts().join(', ')}`]);
  if (layers.forces && frame.estimate && frame.estimate.grasps.length) parts.push([COLOURS.reaction, 'force of the model']);
  if (layers.feature && frame.feature && placesOf(frame.feature.kind, frame.feature.value).length) {
    parts.push([COLOURS.feature, 'feature']);
    if (frame.feature.revision >= 0) parts.push([COLOURS.target, 'target']);
  }
  if (frame.seen) parts.push([COLOURS.seen, 'seen by a camera']);
  if (layers.nodes) parts.push([COLOURS.constrained, 'held'], [COLOURS.loaded, 'loaded']);
  const text = JSON.stringify(parts), key = byId('key');
  if (key.dataset.text === text) return;
  key.dataset.text = text;
  key.textContent = '';
  for (const [colour, name] of parts) {
    const item = document.createElement('span'), dot = document.createElement('i');
    dot.style.background = colour;
    item.append(dot, name);
    key.append(item);
  }
}

function showFrame() {
  const hasEstimate = showShapes();
  stage.placeRobot(0, frame.links, layers.robot);
  stage.placeRobot(1, frame.links_1, layers.robot);
  obstacles.show(frame, estimate.mesh ? estimate : truth, layers.obstacles);
  arrows.show(frame, hasEstimate ? pushes() : [], layers.forces);
  marks.show(frame.feature, pointer.dragged, layers.feature, size);
  seen.visible = Boolean(frame.seen);
  if (frame.seen) seen.geometry.setAttribute('position', new THREE.BufferAttribute(frame.seen, 3));
  chosen.visible = pointer.picked >= 0 && hasEstimate && layers.estimate;
  if (chosen.visible) {
    chosen.position.copy(estimate.node(pointer.picked));
    chosen.scale.setScalar(0.006 * size);
  }
}

/** Text next to the image: not updated with every frame, for legibility. */
function showTexts() {
  pointer.showPicked();
  panels.showState(frame, health, connected);
  panels.showNumbers(frame);
  fingertips.show(frame, panels.tab === 'plots');
  if (health) panels.showHealth(health);
  if (frame.player) timeline.show(frame.player);
  showKey();
}

/** Manual forces: of this page, and of other pages or programs, at the nodes nearest to their rest points. */
function pushes() {
  const list = pointer.pull ? [pointer.pull] : frame.push ? [frame.push] : [];
  return list.map((push) => push.node === undefined
      ? {at: estimate.node(estimate.nearestAtRest(push.at)).toArray(), force: push.force} : push);
}

/** Whether anything except the shapes has changed since the last image: arrows, marks, robots, layers. */
function othersDiffer() {
  const {links, links_1, obstacle_poses: poses, seen: points, contacts, predicted, truth_contacts, estimate: grasps, feature, push} = frame;
  const text = JSON.stringify([links && [...links], links_1 && [...links_1], poses && [...poses], contacts, predicted, truth_contacts, grasps,
    push, pointer.pull, pointer.dragged, pointer.picked, feature && [feature.value, feature.target, feature.revision], points && [...points.slice(0, 30)],
    layers, estimate.group.visible, truth.group.visible, size]);
  const differ = text !== othersDrawn;
  othersDrawn = text;
  return differ;
}

const timing = {show: 0, render: 0};  // ms per frame, of this thread
const pace = new Pace();
stage.controls.addEventListener('change', () => pace.moved(performance.now()));
let plotted = 0, frames = 0, pictures = 0, drew = false, othersDrawn = '';
function animate(now) {
  requestAnimationFrame(animate);
  stage.setSharpness(pace.next(now, drew));
  const fresh = frame !== drawn;
  drew = false;
  if (!frame || (!fresh && !stage.dirty)) return;
  const begin = performance.now();
  showFrame();
  const shown = performance.now();
  timing.show += 0.05 * (shown - begin - timing.show);
  if (othersDiffer() || stage.dirty) {
    stage.render();
    drew = true;
    ++pictures;
    timing.render += 0.05 * (performance.now() - shown - timing.render);
  }
  drawn = frame;
  if (!fresh) return;
  ++frames;
  send({type: 'ack', frame: frame.frame});
  if (now - plotted > 90) {
    plotted = now;
    showTexts();
    plot();
  }
}
requestAnimationFrame(animate);

byId('field').onchange = () => send({type: 'colour', field: byId('field').value});
for (const button of document.querySelectorAll('#layers button')) {
  button.onclick = () => setLayer(button.dataset.layer, !layers[button.dataset.layer]);
}
byId('home').onclick = () => {
  stage.touched = false;
  frameObject();
};

// For inspection of the page from outside, by a test or the console.
window.palpate = {stage, estimate, truth, obstacles, legend, layers, pointer, control, link, pace, fingertips, consistency, fields: FIELDS, timing,
  get frame() { return frame; }, get health() { return health; }, get frames() { return frames; }, get pictures() { return pictures; },
  get connected() { return connected; }, frameObject};
