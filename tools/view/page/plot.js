// Lines over time on a canvas.

import {niceAbove, tickText} from './colours.js';
import {cleared} from './software.js';

/** A power of ten of microseconds. */
function durationText(e) { return e < 3 ? `${10 ** e} \u00b5s` : e < 6 ? `${10 ** (e - 3)} ms` : `${10 ** (e - 6)} s`; }

export class Plot {
  /** `lines`: [{name, colour}]; `seconds`: the window of a live plot. */
  constructor(canvas, lines, {unit = '', seconds = 60, decades = null, tick = durationText} = {}) {
    this.canvas = canvas;
    this.lines = lines.map((line) => ({...line, time: [], value: []}));
    this.unit = unit;
    this.seconds = seconds;
    this.decades = decades;  // [a, b]: a logarithmic scale from 10^a to 10^b
    this.tick = tick;  // text of 10^e on it
    this.fixed = null;  // {duration}: a log's, with a cursor
  }

  add(time, values) {
    const line0 = this.lines[0];
    if (line0.time.length && time <= line0.time[line0.time.length - 1]) return;
    this.lines.forEach((line, i) => {
      line.time.push(time);
      line.value.push(values[i] ?? NaN);
      if (line.time.length > 4000) {
        line.time.splice(0, 1000);
        line.value.splice(0, 1000);
      }
    });
  }

  /** A complete log at once: lists of time (s) and value by line. */
  fix(duration, series) {
    this.fixed = {duration};
    this.lines.forEach((line, i) => Object.assign(line, series[i]));
  }

  clear() { for (const line of this.lines) line.time = [], line.value = []; }

  /** Ticks [value, text], and the position of a value, 0 to 1. */
  linear(from) {
    let most = 0;
    for (const {time, value} of this.lines)
      for (let i = 0; i < time.length; ++i) if (time[i] >= from && value[i] > most) most = value[i];
    const ceiling = most > 0 ? niceAbove(most * 1.05) : 1;
    return {ticks: [0, ceiling / 2, ceiling].map((v) => [v, tickText(v)]), share: (v) => v / ceiling};
  }

  logarithmic() {
    const [a, b] = this.decades, ticks = [];
    for (let e = a; e <= b; ++e) ticks.push([10 ** e, this.tick(e)]);
    return {ticks, share: (v) => (Math.log10(Math.max(v, 1e-12)) - a) / (b - a)};
  }

  /** `now`: s, the right end of a live plot or the cursor of a log's. */
  draw(now) {
    const {pen, width, height} = cleared(this.canvas);
    if (!pen) return;
    const left = 50, right = 8, top = 20, bottom = 17, w = width - left - right, h = height - top - bottom;
    const end = this.fixed ? this.fixed.duration : now, span = this.fixed ? this.fixed.duration : this.seconds;
    const x = (t) => left + w * (t - end + span) / span;
    const {ticks, share} = this.decades ? this.logarithmic() : this.linear(end - span);
    const y = (v) => top + h * (1 - Math.min(Math.max(share(v), -0.1), 1.1));

    pen.font = '10.5px system-ui, "DejaVu Sans", sans-serif';
    pen.lineWidth = 1;
    pen.textBaseline = 'middle';
    pen.textAlign = 'right';
    for (const [v, text] of ticks) {
      pen.strokeStyle = '#24303c';
      pen.beginPath();
      pen.moveTo(left, y(v));
      pen.lineTo(width - right, y(v));
      pen.stroke();
      pen.fillStyle = '#93a3b3';
      pen.fillText(text, left - 6, y(v));
    }
    pen.textBaseline = 'alphabetic';
    for (let i = 0; i <= 3; ++i) {
      const t = end - span + span * i / 3;
      pen.textAlign = i === 0 ? 'left' : i === 3 ? 'right' : 'center';
      const seconds = this.fixed ? t : t - end;
      pen.fillText(`${tickText(Number(seconds.toFixed(1)))}${i === 3 ? ' s' : ''}`, x(t), height - 4);
    }
    pen.save();
    pen.beginPath();
    pen.rect(left, top - 2, w, h + 4);
    pen.clip();
    for (const {colour, time, value} of this.lines) {
      pen.strokeStyle = colour;
      pen.lineWidth = 1.5;
      pen.beginPath();
      let drawing = false;
      for (let i = 0; i < time.length; ++i) {
        const good = value[i] !== null && Number.isFinite(value[i]) && (i === 0 || time[i] - time[i - 1] < Math.max(2, span / 50));
        if (drawing && good) pen.lineTo(x(time[i]), y(value[i]));
        else pen.moveTo(x(time[i]), y(value[i] || 0));
        drawing = Number.isFinite(value[i]) && value[i] !== null;
      }
      pen.stroke();
    }
    if (this.fixed) {
      pen.strokeStyle = '#e4ebf1';
      pen.lineWidth = 1;
      pen.beginPath();
      pen.moveTo(x(now), top);
      pen.lineTo(x(now), top + h);
      pen.stroke();
    }
    pen.restore();
    let at = left;
    pen.textAlign = 'left';
    for (const {name, colour} of this.lines) {
      pen.fillStyle = colour;
      pen.fillRect(at, 9, 10, 3);
      pen.fillStyle = '#c5d0da';
      pen.fillText(name, at + 14, 14);
      at += 26 + pen.measureText(name).width;
    }
    pen.textAlign = 'right';
    pen.fillStyle = '#93a3b3';
    pen.fillText(this.unit, width - right, 14);
  }
}
