// Whether the wrenches agree with the model: the test over time, and what explains a contradiction.

import {fill, fixed} from './panels.js';
import {Plot} from './plot.js';

const LEAST_PROBABILITY = 0.01;  // of an explanation that is listed
const RANKS = ['most likely', 'second', 'third'];
const STANDS_OUT = 3;  // standard deviations
const SERIES = 3;  // number of the test in a log's series: threshold and contradiction follow

const byId = (id) => document.getElementById(id);

/** `difference` and `deviation` of a component; a negative deviation means that there is no wrench. */
function cell(difference, deviation, factor, digits) {
  if (!(deviation >= 0)) return '\u2013';
  const kind = Math.abs(difference) > STANDS_OUT * deviation ? 'warn' : '';
  return {text: `${fixed(factor * difference, digits)} \u00b1 ${fixed(factor * deviation, digits)}`, kind};
}

export class Consistency {
  constructor() {
    this.plot = new Plot(byId('consistency-plot'), [
      {name: 'test', colour: '#4cc2ff'}, {name: 'threshold', colour: '#f0b440'}, {name: 'contradiction', colour: '#f2686a'}],
      {decades: [-1, 3], tick: (e) => String(Number((10 ** e).toPrecision(1)))});
  }

  /** The plot begins with the whole of a log, or with what palpate-view has kept. */
  begin({log, history}) {
    this.plot.clear();
    if (log) {
      this.plot.fix(log.duration, log.series.slice(SERIES, SERIES + 3).map(({time, value}) => ({time, value})));
      return;
    }
    this.plot.fixed = null;
    const now = performance.now() / 1e3;
    history.time.forEach((t, i) => {
      if (history.test[i] !== null) this.plot.add(now + t, [history.test[i], history.threshold[i], history.contradiction[i]]);
    });
  }

  /** `time`: of the plot, s. `visible`: whether the tab that holds the panel is open. */
  show({discrepancy: test, player}, time, visible) {
    const contradicts = Boolean(test && test.inconsistent);
    if (test && !player) this.plot.add(time, [test.test, test.threshold, contradicts ? test.test : NaN]);
    const banner = byId('contradiction');
    banner.hidden = !contradicts;
    if (contradicts) banner.textContent = `The wrenches contradict the model (${test.component})`;
    byId('consistency').hidden = !test && !this.plot.lines[0].time.length;
    if (byId('consistency').hidden || !visible) return;
    const now = byId('consistency-now');
    now.textContent = test ? `${fixed(test.test, 2)}, threshold ${fixed(test.threshold, 2)}` : 'not tested';
    now.style.color = contradicts ? 'var(--bad)' : '';
    this.plot.draw(time);
    this.explain(test, contradicts);
    fill(byId('differences'), test ? this.differences(test.wrenches) : []);
  }

  explain(test, contradicts) {
    const lines = [];
    if (contradicts) {
      lines.push(`For ${fixed(test.duration, 1)} s: ${test.component}`);
      if (!test.explanations.length) lines.push('no explanation yet');
      test.explanations.forEach(({text, probability}, i) => {
        if (i === 0 || probability >= LEAST_PROBABILITY) lines.push(`${RANKS[i] || `${i + 1}th`}: ${text}; ${fixed(probability, 2)}`);
      });
    }
    if (test && test.adopted) lines.push(`The estimate is corrected for: ${test.adopted}`);
    const list = byId('explanations');
    if (list.dataset.text === lines.join('\n')) return;
    list.dataset.text = lines.join('\n');
    list.replaceChildren(...lines.map((line) => {
      const item = document.createElement('li');
      item.textContent = line;
      return item;
    }));
  }

  differences(wrenches) {
    const rows = [['difference', 'x', 'y', 'z']];
    wrenches.forEach(({difference, deviation}, hand) => {
      for (const [unit, first, factor, digits] of [['N', 0, 1, 2], ['mN m', 3, 1e3, 0]])
        rows.push([`hand ${hand}, ${unit}`, ...[0, 1, 2].map((i) => cell(difference[first + i], deviation[first + i], factor, digits))]);
    });
    return rows;
  }
}
