// Colours of numbers, and fixed colours used throughout the page.

// Viridis (Smith and van der Walt, CC0) at ninths.
const STOPS = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
               [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];

// Blue below, white at zero, red above: distinguishable with colour blindness as well.
const DIVERGING = [[5, 48, 97], [66, 148, 194], [247, 247, 247], [214, 97, 77], [102, 0, 31]];

/** Red, green, blue, 0 to 1, of a fraction from 0 to 1, into `out` from `at` on. */
export function colourOf(share, out = [0, 0, 0], at = 0, stops = STOPS) {
  const x = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(x), stops.length - 2), f = x - i;
  for (let c = 0; c < 3; ++c)
    out[at + c] = (stops[i][c] + f * (stops[i + 1][c] - stops[i][c])) / 255;
  return out;
}

/** Red, green, blue, 0 to 1, of a fraction from -1 to 1. */
export function divergingOf(share) { return colourOf(0.5 * (share + 1), [0, 0, 0], 0, DIVERGING); }

export const COLOURS = {
  truth: '#f0a83c', target: '#ff5d5d', feature: '#58e08c', reaction: '#8fb7d9', truthForce: '#f0a83c',
  push: '#ff79e1', unknown: '#ffe25a', predicted: '#36c5b0', seen: '#9fd8ff', constrained: '#ff5050', loaded: '#4de08a',
  node: '#ffffff', obstacle: '#9a8fd0',
};

/** Of a contact by its source: wrists, fingertips, a person. */
export function colourOfSource(source) {
  if (source <= 1) return '#4cc2ff';
  return source === 7 ? COLOURS.push : '#b6f26a';
}

export function nameOfSource(source) {
  if (source <= 1) return source === 0 ? 'wrist' : 'second wrist';
  return source === 7 ? 'pushed by hand' : `fingertip ${source - 2}`;
}

/** Name and unit of a field: factor from SI to the displayed unit. */
export const FIELDS = {
  displacement: {title: 'Displacement', unit: 'mm', factor: 1e3, least: 1},
  strain: {title: 'Largest principal strain', unit: '%', factor: 100, least: 1},
  stress: {title: 'Von Mises stress', unit: 'kPa', factor: 1e-3, least: 0.1},
  uncertainty: {title: 'Standard deviation', unit: 'mm', factor: 1e3, least: 0.1},
};

/** The smallest number with few digits that is at least x. */
export function niceAbove(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  for (const m of [1, 1.2, 1.6, 2, 2.4, 3, 4, 5, 6, 8, 10]) if (m * power >= x * (1 - 1e-9)) return m * power;
  return 10 * power;
}

export function tickText(x) {
  return Math.abs(x) >= 1e4 ? x.toExponential(0) : String(Number(x.toPrecision(3)));
}
