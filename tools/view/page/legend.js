// The legend: meaning of the colours, and the top of their scale.

import {colourOf, FIELDS, niceAbove, tickText} from './colours.js';

const SHRINK_AFTER = 4000;  // ms for which the values have been below half of the scale

export class Legend {
  constructor() {
    this.tops = {};
    this.smallSince = {};
    const canvas = document.getElementById('legend-bar'), pen = canvas.getContext('2d');
    for (let x = 0; x < canvas.width; ++x) {
      const [r, g, b] = colourOf(x / (canvas.width - 1)).map((c) => Math.round(255 * c));
      pen.fillStyle = `rgb(${r},${g},${b})`;
      pen.fillRect(x, 0, 1, canvas.height);
    }
  }

  /** Top of the scale in SI that contains `largest`: grows at once, shrinks late, so that colours are steady. */
  top(field, largest, now = performance.now()) {
    const {factor, least} = FIELDS[field];
    const wanted = niceAbove(Math.max(largest * factor, least)) / factor;
    const present = this.tops[field];
    if (present === undefined || wanted > present) {
      this.tops[field] = wanted;
      delete this.smallSince[field];
    } else if (wanted < present) {
      this.smallSince[field] = this.smallSince[field] ?? now;
      if (now - this.smallSince[field] > SHRINK_AFTER) {
        this.tops[field] = wanted;
        delete this.smallSince[field];
      }
    } else {
      delete this.smallSince[field];
    }
    return this.tops[field];
  }

  show(field, top, note) {
    const {title, unit, factor} = FIELDS[field];
    const text = `${field} ${top} ${note}`;
    if (text === this.text) return;
    this.text = text;
    document.getElementById('legend-title').textContent = `${title}, ${unit}`;
    document.getElementById('legend-note').textContent = note;
    const ticks = document.getElementById('legend-ticks');
    ticks.textContent = '';
    for (let i = 0; i <= 4; ++i) {
      const tick = document.createElement('span');
      tick.textContent = tickText(top * factor * i / 4);
      tick.style.left = `${25 * i}%`;
      ticks.append(tick);
    }
  }
}
