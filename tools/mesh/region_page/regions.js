// Groups of a mesh: painted here, found and kept by palpate-mesh.

import {Link, takeToken} from './link.js';
import {RegionPointer} from './region_pointer.js';
import {RegionView} from './region_view.js';
import {Stage} from './stage.js';

const byId = (id) => document.getElementById(id);
const token = takeToken();
const stage = new Stage(byId('canvas'));
const view = new RegionView(stage.scene);
let state = {groups: [], conflict: '', changed: false, steps: 0}, connected = false, granted = false, size = 1;
let active = {name: 'clamp', of: 'faces'};  // the group that is painted

const link = new Link({
  open() {
    connected = true;
    if (token) link.send({type: 'control', token});
  },
  close() {
    connected = granted = false;
    showState();
  },
  hello({file}) { byId('file').textContent = file; },
  control(message) {
    granted = message.granted;
    if (!granted && message.reason) complain(message.reason);
    showState();
  },
  mesh(mesh) {
    if (view.mesh && view.mesh.hash === mesh.hash) return;  // after a break of the connection
    view.setMesh(mesh);
    const box = view.bounds();
    size = box.getSize(new THREE.Vector3()).length();
    ['lower', 'upper'].forEach((corner) => ['x', 'y', 'z'].forEach((axis) => {
      byId(`${corner}-${axis}`).value = Number(box[corner === 'lower' ? 'min' : 'max'][axis].toPrecision(6));
    }));
    stage.controls.minDistance = 0.05 * size;
    stage.controls.maxDistance = 20 * size;
    stage.camera.near = 0.005 * size;
    stage.camera.far = 40 * size;
    stage.frame(box);
    stage.resize();
    showSliders();
  },
  groups(message) {
    message.groups.forEach((group, i) => { group.outer = message[`faces_${i}`]; });
    state = message;
    byId('reason').textContent = '';
    const kept = state.groups.find(({name}) => name === active.name);
    if (kept) active = {name: kept.name, of: kept.of};
    showState();
  },
  error({reason}) { complain(reason); },
});

function complain(reason) { byId('reason').textContent = reason; }

const radius = () => size * 10 ** Number(byId('radius').value);
const angle = () => Number(byId('angle').value);

/** Asks for a change of the active group; `stroke` joins several to one step of Undo. */
function select(how, edit = pointer.edit, stroke = 0) {
  link.send({type: 'select', group: active.name, of: active.of, edit, stroke, ...how});
}

const pointer = new RegionPointer({stage, view, select, radius, angle});

function showState() {
  const pill = byId('saved');
  pill.textContent = !connected ? 'not connected' : !granted ? 'reading only' : state.changed ? 'not saved' : 'saved';
  pill.className = `pill ${!connected ? 'lost' : state.changed ? 'degraded' : granted ? 'active' : 'inactive'}`;
  byId('undo').disabled = !granted || !state.steps;
  for (const id of ['save', 'finish']) byId(id).disabled = !granted;
  byId('contradiction').hidden = !state.conflict;
  byId('contradiction').textContent = state.conflict;
  view.paint(state.groups, active.name);
  showGroups();
  stage.dirty = true;
}

function showGroups() {
  const groups = [...state.groups];
  if (!groups.some(({name}) => name === active.name)) groups.push({...active, nodes: 0, faces: 0, elements: 0, area: 0, volume: 0});
  byId('groups').replaceChildren(...groups.map((group) => {
    const row = document.createElement('tr'), dot = document.createElement('i'), button = document.createElement('button');
    row.dataset.group = group.name;
    row.classList.toggle('on', group.name === active.name);
    row.onclick = () => choose(group.name, group.of);
    if (group.colour) dot.style.background = `rgb(${group.colour.map((c) => Math.round(255 * c)).join(' ')})`;
    const name = row.insertCell(), count = row.insertCell(), extent = row.insertCell(), last = row.insertCell();
    name.append(dot, group.name);
    count.textContent = group.elements ? `${group.elements} elements` : `${group.faces} faces`;
    extent.textContent = group.elements ? `${(1e6 * group.volume).toPrecision(4)} cm\u00b3` : `${(1e4 * group.area).toPrecision(4)} cm\u00b2`;
    button.textContent = '\u00d7';
    button.title = `delete ${group.name}`;
    button.disabled = !granted || !group.colour;
    button.onclick = (event) => {
      event.stopPropagation();
      link.send({type: 'delete', group: group.name});
    };
    last.append(button);
    return row;
  }));
}

function choose(name, of) {
  active = {name, of};
  showState();
}

function showSliders() {
  byId('radius-now').textContent = `${(1e3 * radius()).toPrecision(3)} mm`;
  byId('angle-now').textContent = `${angle()}\u00b0`;
}

for (const corner of ['lower', 'upper']) {
  byId('box').append(corner);
  for (const axis of 'xyz') {
    const input = document.createElement('input');
    input.id = `${corner}-${axis}`;
    input.type = 'number';
    input.step = 'any';
    input.setAttribute('aria-label', `${corner} ${axis}`);
    byId('box').append(input);
  }
}
const cornerOf = (name) => [...'xyz'].map((axis) => Number(byId(`${name}-${axis}`).value));

byId('new-group').onsubmit = (event) => {
  event.preventDefault();
  const name = byId('new-name').value.trim();
  if (!name) return;
  const known = state.groups.find((group) => group.name === name);
  choose(name, known ? known.of : byId('new-of').value);
  byId('new-name').value = '';
};
byId('box-apply').onclick = () => select({by: 'box', lower: cornerOf('lower'), upper: cornerOf('upper')});
byId('all-apply').onclick = () => select({by: 'all'});
byId('undo').onclick = () => link.send({type: 'undo'});
byId('save').onclick = () => link.send({type: 'save'});
byId('finish').onclick = () => link.send({type: 'finish'});
byId('home').onclick = () => { stage.frame(view.bounds()); };
for (const id of ['radius', 'angle']) byId(id).oninput = showSliders;
document.addEventListener('keydown', (event) => {
  if (!(event.ctrlKey || event.metaKey) || !['z', 's'].includes(event.key)) return;
  event.preventDefault();
  link.send({type: event.key === 'z' ? 'undo' : 'save'});
});

let pictures = 0;
function animate() {
  requestAnimationFrame(animate);
  if (!stage.dirty || !view.mesh) return;
  stage.render();
  ++pictures;
}
requestAnimationFrame(animate);
showState();

// For inspection of the page from outside, by a test or the console.
window.palpate = {stage, view, pointer, link, get state() { return state; }, get active() { return active; },
  get connected() { return connected; }, get granted() { return granted; }, get frames() { return pictures; }};
