// Numbers, health and events at the side.

import {COLOURS, colourOfSource, nameOfSource} from './colours.js';

const byId = (id) => document.getElementById(id);
const STATES = ['unconfigured', 'inactive', 'active', 'degraded', 'faulted', 'finalized'];
const PHASES = ['whole cycle', 'read', 'sensing', 'contact', 'estimation, deformation', 'feature', 'control', 'gate', 'publish', 'wake-up'];
const SHAPES = ['current', 'old', 'not converged'];
const MOST_EVENTS = 300;

export function fixed(x, digits) { return x === null || !Number.isFinite(x) ? '\u2013' : x.toFixed(digits); }

/** Fills a table; cells are texts, or {text, kind, dot}. */
export function fill(table, rows, head) {
  const all = head ? [head, ...rows] : rows;
  while (table.rows.length > all.length) table.deleteRow(-1);
  all.forEach((cells, r) => {
    const row = table.rows[r] || table.insertRow();
    while (row.cells.length > cells.length) row.deleteCell(-1);
    cells.forEach((cell, c) => {
      const at = row.cells[c] || row.insertCell();
      const {text, kind = '', dot = ''} = typeof cell === 'object' ? cell : {text: cell};
      const key = `${text}|${kind}|${dot}|${head && r === 0}`;
      if (at.dataset.key === key) return;
      at.dataset.key = key;
      at.className = kind;
      at.textContent = text;
      at.style.color = head && r === 0 ? 'var(--quiet)' : '';
      if (dot) {
        const mark = document.createElement('i');
        mark.style.background = dot;
        at.prepend(mark);
      }
    });
  });
}

/** A standard deviation in units of 1 / `factor`; a negative one means that the value is not estimated, but as configured. */
function orConfigured(deviation, factor, digits, unit) {
  return deviation < 0 ? '(configured)' : `\u00b1 ${fixed(factor * deviation, digits)}${unit}`;
}

/** Display of a feature's numbers: factor and unit by kind. */
export function unitOf(kind) {
  if (kind === 'angle') return {factor: 180 / Math.PI, unit: '\u00b0', digits: 2};
  if (kind === 'curvature') return {factor: 1, unit: '1/m', digits: 3};
  return {factor: 1e3, unit: 'mm', digits: 2};
}

export function stateName(health) { return STATES[health.state] || 'unknown'; }

export class Panels {
  constructor() {
    this.tab = 'plots';
    for (const button of document.querySelectorAll('#tabs button')) {
      button.onclick = () => this.open(button.dataset.tab);
    }
    this.events = 0;
    this.received = new Map();
  }

  open(tab) {
    this.tab = tab;
    for (const button of document.querySelectorAll('#tabs button')) button.classList.toggle('on', button.dataset.tab === tab);
    for (const panel of document.querySelectorAll('.tab')) panel.hidden = panel.id !== `tab-${tab}`;
  }

  showState(frame, health, connected) {
    const pill = byId('state');
    const silent = !health || frame.health_age_ms > 1500;
    const name = !connected ? 'no server' : silent ? 'no daemon' : stateName(health);
    pill.textContent = name;
    pill.className = `pill ${!connected || silent ? 'lost' : name}`;
    byId('reason').textContent = connected && !silent ? health.reason : '';
    const age = frame.shape ? frame.shape.age_ms : 0, stale = byId('stale');
    stale.hidden = connected && age < 1000;
    stale.textContent = connected ? `The estimate is ${fixed(age / 1e3, 1)} s old` : 'No connection: what is shown is old';
  }

  showNumbers(frame) {
    if (this.tab !== 'plots') return;
    const rows = [], {feature, estimate, shape, twist} = frame;
    if (shape) {
      const late = shape.age_ms > 500;
      rows.push(['Shape', {text: late ? `${fixed(shape.age_ms / 1e3, 1)} s old` : SHAPES[shape.status] || '?', kind: late ? 'bad' : shape.status ? 'warn' : ''}]);
    }
    if (feature) {
      const {factor, unit, digits} = unitOf(feature.kind);
      const place = /point|pose|fourier/.test(feature.kind);
      const list = (values, n) => values.slice(0, n).map((v) => fixed(v * factor, place ? 1 : digits)).join('  ') + (values.length > 7 ? ' \u2026' : '');
      rows.push([`Feature, ${feature.kind}, ${unit}`, list(feature.value, 3)]);
      if (feature.revision >= 0) {
        rows.push([`Target, ${unit}`, list(feature.target, 3)]);
        const norm = Math.hypot(...feature.unreachable);
        rows.push([`Of the error unreachable, ${unit}`, fixed(norm * factor, digits)]);
      }
    }
    if (twist) {
      const speed = Math.hypot(...twist.twist.slice(0, 3));
      rows.push(['Hand commanded, mm/s', twist.valid ? fixed(1e3 * speed, 1) : 'no']);
    }
    if (estimate) {
      // Before the first cycle the message holds zeros.
      if (estimate.young_modulus > 1.001) {
        rows.push(['Young\u2019s modulus, kPa', `${fixed(estimate.young_modulus / 1e3, 2)} ${orConfigured(estimate.young_modulus_share, 100, 0, ' %')}`]);
        rows.push(['Poisson\u2019s ratio', `${fixed(estimate.poisson_ratio, 3)} ${orConfigured(estimate.poisson_ratio_deviation, 1, 3, '')}`]);
      }
      if (estimate.innovation >= 0) rows.push(['Innovation test', fixed(estimate.innovation, 2)]);
    }
    fill(byId('numbers'), rows);
    const contacts = (frame.contacts || []).map((c) => [
      {text: nameOfSource(c.source), dot: colourOfSource(c.source)}, `${fixed(Math.hypot(...c.wrench.slice(0, 3)), 3)} N`,
      `${fixed(1e3 * Math.hypot(...c.wrench.slice(3)), 1)} mN m`]);
    if (estimate) {
      for (const grasp of estimate.grasps)
        contacts.push([{text: 'grasp, as the model has it', dot: '#8fb7d9'}, `${fixed(Math.hypot(...grasp.wrench.slice(0, 3)), 3)} N`,
                       `${fixed(1e3 * Math.hypot(...grasp.wrench.slice(3)), 1)} mN m`]);
    }
    if (frame.predicted) {
      const {sum, points} = frame.predicted, sliding = points.filter((point) => point.slips).length;
      for (const {obstacle, force} of sum)
        contacts.push([{text: `${obstacle}, predicted`, dot: COLOURS.predicted}, `${fixed(force, 3)} N`, '']);
      if (points.length) contacts.push(['points in contact, of these sliding', `${points.length}`, `${sliding}`]);
    }
    for (const grasp of frame.truth_contacts || [])
      contacts.push([{text: 'grasp, true', dot: '#f0a83c'}, `${fixed(Math.hypot(...grasp.wrench.slice(0, 3)), 3)} N`,
                     `${fixed(1e3 * Math.hypot(...grasp.wrench.slice(3)), 1)} mN m`]);
    fill(byId('contacts'), contacts.length ? contacts : [['none', '']]);
  }

  showHealth(health) {
    if (this.tab !== 'health') return;
    fill(byId('phases'), health.p50_us.map((p50, i) => [PHASES[i], fixed(p50, 0), fixed(health.p99_us[i], 0), fixed(health.max_us[i], 0)]),
         ['', '50 %', '99 %', 'most']);
    const rows = health.inputs.map((input) => [
      input.name, input.received, {text: input.age_ms < 0 ? 'never' : fixed(input.age_ms, 1), kind: input.age_ms > 200 ? 'warn' : ''},
      {text: input.lost, kind: input.lost ? 'warn' : ''}, {text: input.rejected, kind: input.rejected ? 'warn' : ''}]);
    fill(byId('inputs'), rows, ['', 'came', 'age, ms', 'lost', 'refused']);
    const counted = (name, value) => [name, {text: value, kind: value > 0 ? 'warn' : ''}];
    const models = health.models.map((m) => [`model ${m.name}, ${m.executor}`, `${m.steps} steps, ${m.late} late`]);
    fill(byId('counters'), [
      ['cycles', health.cycles], counted('late wake-ups', health.overruns), ['their lateness, ms', fixed(health.overrun_us / 1e3, 1)],
      counted('shapes not converged', health.not_converged), ['page faults', health.page_faults],
      ['allocations', health.allocations < 0 ? 'not counted' : health.allocations], ['commands that the gate limited', health.gate_limited],
      counted('that it rejected', health.gate_rejected), counted('commands without access', health.commands_rejected),
      counted('malformed datagrams', health.malformed), counted('datagrams lost, buffer full', health.overflowed),
      counted('telemetry lost', health.telemetry_dropped), ...models]);
  }

  /** Messages of the types that --types describes: channel, type and age, and a row for each value. */
  showMessages({messages}) {
    byId('messages-tab').hidden = false;
    if (this.tab !== 'messages') return;
    const rows = [];
    for (const message of messages) {
      const age = message.age_ms < 1000 ? '' : `, ${fixed(message.age_ms / 1e3, 0)} s old`;
      const bad = message.malformed ? `, ${message.malformed} malformed` : '';
      rows.push([{text: message.channel, kind: bad ? 'warn' : ''}, {text: `${message.type}${age}${bad}`, kind: bad ? 'warn' : ''}]);
      rows.push(...message.lines.map(([name, text]) => [`\u2003${name}`, text]));
      if (message.left_out) rows.push(['', `and ${message.left_out} values more`]);
    }
    fill(byId('messages'), rows.length ? rows : [['no message of these types', '']]);
  }

  addEvents({events, reset}) {
    const list = byId('events');
    if (reset) {
      list.textContent = '';
      this.events = 0;
    }
    for (const event of events) {
      const item = document.createElement('li'), time = document.createElement('time'), name = document.createElement('b');
      time.textContent = new Date(event.time_us / 1e3).toTimeString().slice(0, 8);
      name.textContent = event.event;
      item.append(time, name, ` ${[event.slot, event.instance, event.component].filter((t) => t && t !== 'all').join(' ')}`);
      if (event.reason) {
        const why = document.createElement('div');
        why.textContent = event.reason;
        item.append(why);
      }
      item.className = /fault|refused|no_access|wrong/.test(event.event) ? 'bad' : /degraded|replacing/.test(event.event) ? 'warn'
          : /replaced|start|active|target/.test(event.event) && event.event !== 'inactive' ? 'good' : '';
      list.prepend(item);
      while (list.childElementCount > MOST_EVENTS) list.lastChild.remove();
      ++this.events;
    }
    byId('event-count').textContent = this.events ? this.events : '';
  }
}
