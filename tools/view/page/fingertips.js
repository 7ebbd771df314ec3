// Electrodes of a fingertip on its unrolled skin, as differences from rest, and its other signals.

import {divergingOf} from './colours.js';
import {fill, fixed} from './panels.js';
import {cleared} from './software.js';

const TARE_MESSAGES = 5;  // whose mean is the rest
const LEAST_RANGE = 20;  // counts, of the colours
const SHRINK = 0.98;  // of the range with each drawing: colours during a contact can be compared
const OLD = 500;  // ms
const LENGTH = 15.5, RADIUS = 11.2;  // mm: the skin, from the tip's centre backwards, and around
const DOT = 1.25;  // mm
const VALID = ['electrodes', 'PAC', 'PDC', 'temperature'];

const byId = (id) => document.getElementById(id);
const signed = (x) => `${x < 0 ? '\u2212' : '+'}${Math.abs(Math.round(x))}`;
const nameOf = (channel) => channel.replace(/^BIOTAC_(\d)(_1)?$/, (_, finger, second) => `${second ? 'second hand, ' : ''}fingertip ${finger}`);

export class Fingertips {
  constructor() {
    this.places = [];
    this.rests = new Map();
    this.names = '';
    byId('electrodes').onclick = () => this.rests.clear();
  }

  /** `electrodes`: their places, mm, along the finger towards the tip and around it. */
  setHello({electrodes}) {
    this.places = electrodes;
    this.rests.clear();
  }

  /** The rest of a fingertip: the mean of its first messages since the tare. */
  restOf({channel, electrodes, pdc, seq, session}) {
    if (!this.rests.has(channel)) this.rests.set(channel, {count: 0, electrodes: electrodes.map(() => 0), pdc: 0, range: LEAST_RANGE});
    const rest = this.rests.get(channel), message = `${session} ${seq}`;
    if (rest.count < TARE_MESSAGES && rest.message !== message) {
      ++rest.count;
      electrodes.forEach((counts, i) => { rest.electrodes[i] += (counts - rest.electrodes[i]) / rest.count; });
      rest.pdc += (pdc - rest.pdc) / rest.count;
    }
    rest.message = message;
    return rest;
  }

  /** `visible`: whether the tab that holds the panel is open. */
  show(frame, visible) {
    const tips = frame.fingertips || [];
    byId('fingertips').hidden = !tips.length;
    for (const tip of tips) this.restOf(tip);
    if (!tips.length || !visible) return;
    this.offer(tips.map((tip) => tip.channel));
    const tip = tips.find((one) => one.channel === byId('finger').value), rest = this.restOf(tip);
    this.differences = tip.electrodes.map((counts, i) => counts - rest.electrodes[i]);
    rest.range = Math.max(LEAST_RANGE, rest.range * SHRINK, ...this.differences.map(Math.abs));
    const age = byId('fingertip-age');
    age.textContent = tip.age_ms < OLD ? `${fixed(tip.age_ms, 0)} ms old` : `${fixed(tip.age_ms / 1e3, 1)} s old`;
    age.style.color = tip.age_ms < OLD ? '' : 'var(--bad)';
    this.draw(rest.range);
    fill(byId('fingertip-signals'), [
      ['Pressure, PDC', `${tip.pdc} (${signed(tip.pdc - rest.pdc)})`], ['Thermal flux, TAC', tip.tac], ['Temperature, TDC', tip.tdc],
      ['Not valid', VALID.filter((_, i) => !(tip.valid & 1 << i)).join(', ') || 'none'], ['Session', tip.session], ['Message', tip.seq]]);
    this.drawPac(frame[`${tip.channel}_pac`] || []);
  }

  /** The fingertips to choose from. */
  offer(channels) {
    if (this.names === channels.join()) return;
    this.names = channels.join();
    const list = byId('finger'), chosen = list.value;
    list.replaceChildren(...channels.map((channel) => new Option(nameOf(channel), channel)));
    list.value = channels.includes(chosen) ? chosen : channels[0];
  }

  /** Pixel of a place on the skin in the electrodes' canvas; the tip is at the right. */
  pixel([along, around]) {
    const {width, height} = this.size, scale = this.scale = Math.min((width - 8) / (LENGTH + RADIUS), (height - 8) / (2 * RADIUS));
    return [4 + (along + LENGTH) * scale, height / 2 + around * scale];
  }

  draw(range) {
    const {pen, width, height} = cleared(byId('electrodes'));
    if (!pen) return;
    this.size = {width, height};
    const [centre, middle] = this.pixel([0, 0]), radius = RADIUS * this.scale, back = LENGTH * this.scale;
    pen.fillStyle = '#1f2a35';
    pen.strokeStyle = '#4c6478';
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(centre - back, middle - radius);
    pen.arc(centre, middle, radius, -Math.PI / 2, Math.PI / 2);
    pen.lineTo(centre - back, middle + radius);
    pen.closePath();
    pen.fill();
    pen.stroke();
    pen.textAlign = 'center';
    this.places.forEach((place, i) => {
      const [x, y] = this.pixel(place), share = this.differences[i] / range;
      const [r, g, b] = divergingOf(share).map((c) => Math.round(255 * c));
      pen.fillStyle = `rgb(${r},${g},${b})`;
      pen.beginPath();
      pen.arc(x, y, DOT * this.scale, 0, 2 * Math.PI);
      pen.fill();
      pen.fillStyle = Math.abs(share) > 0.6 ? '#ffffff' : '#10161d';
      pen.font = '600 10px system-ui, "DejaVu Sans", sans-serif';
      pen.fillText(signed(this.differences[i]), x, y + 2);
      pen.font = '8px system-ui, "DejaVu Sans", sans-serif';
      pen.fillText(`E${i + 1}`, x, y + 10);
    });
    byId('electrode-range').textContent = `colours: \u00b1${fixed(range, 0)} counts`;
  }

  drawPac(samples) {
    const low = Math.min(...samples), high = Math.max(low + 10, ...samples);
    byId('pac-now').textContent = samples.length ? `last ${samples.length}: ${low} to ${Math.max(...samples)}` : 'none';
    const {pen, width, height} = cleared(byId('pac'));
    if (!pen || !samples.length) return;
    pen.strokeStyle = '#4cc2ff';
    pen.lineWidth = 1.2;
    pen.beginPath();
    samples.forEach((counts, i) => pen.lineTo(4 + (width - 8) * i / Math.max(samples.length - 1, 1), 4 + (height - 8) * (high - counts) / (high - low)));
    pen.stroke();
  }
}
