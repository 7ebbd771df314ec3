// The timeline of a log: play, pause, time, rate.

import {cleared} from './software.js';

const byId = (id) => document.getElementById(id);

export class Timeline {
  constructor(send) {
    this.send = send;
    this.log = null;
    this.dragging = false;
    byId('play').onclick = () => send({type: 'play', action: this.playing ? 'pause' : 'play'});
    const seek = byId('seek');
    seek.oninput = () => {
      this.dragging = true;
      clearTimeout(this.released);
      send({type: 'play', action: 'seek', value: Number(seek.value)});
    };
    seek.onchange = () => { this.released = setTimeout(() => { this.dragging = false; }, 200); };
    byId('rate').onchange = () => send({type: 'play', action: 'rate', value: Number(byId('rate').value)});
    new ResizeObserver(() => this.drawMarks()).observe(byId('track'));
    addEventListener('keydown', (event) => {
      if (!this.log || /INPUT|SELECT|TEXTAREA|BUTTON/.test(event.target.tagName)) return;
      const step = {ArrowLeft: -1, ArrowRight: 1}[event.key];
      if (event.key === ' ') byId('play').click();
      else if (step) send({type: 'play', action: 'seek', value: this.time + step * (event.shiftKey ? 5 : 0.5)});
      else return;
      event.preventDefault();
    });
  }

  setLog(log) {
    this.log = log;
    byId('timeline').hidden = !log;
    if (!log) return;
    byId('seek').max = log.duration;
    this.drawMarks();
  }

  drawMarks() {
    if (!this.log) return;
    const {pen, width} = cleared(byId('marks'));
    if (!pen) return;
    const thumb = 8;  // half of the slider's handle
    for (const [time, what] of this.log.marks) {
      pen.fillStyle = /fault|refused|no_access|wrong/.test(what) ? '#f2686a' : /degraded/.test(what) ? '#f0b440' : '#4cc2ff';
      pen.fillRect(thumb + (width - 2 * thumb) * time / this.log.duration - 1, 1, 2, 7);
    }
  }

  show(player) {
    this.playing = player.playing;
    this.time = player.time;
    byId('play').textContent = player.playing ? '\u275a\u275a' : '\u25b6';
    byId('clock').textContent = `${player.time.toFixed(1)} / ${player.duration.toFixed(1)} s`;
    if (!this.dragging) byId('seek').value = player.time;
    const rate = byId('rate');
    const known = [...rate.options].find((option) => Number(option.value) === player.rate);
    if (known && document.activeElement !== rate) rate.value = known.value;
  }
}
