// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
// Curves on canvases, drawn by uPlot.

export const WINDOW = 10; // s
export const COLOURS = ['#0b6fb8', '#b3261e', '#1d8a5a', '#7a3fa0', '#b08a3c', '#2f7f86', '#a04b73', '#4b5a68'];
const AXIS = { stroke: '#5b6b7a', grid: { stroke: '#e6ebef', width: 1 }, ticks: { show: false },
  font: '11px "DejaVu Sans", sans-serif' };

export const number = (value, digits = 3) => {
  if (value === null || value === undefined) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
};

const value = (u, v) => number(v);

// a little air above and below, and a line of equal values in the middle
const airy = (u, low, high) => {
  if (low === null || high === null) return [-1, 1];
  const air = (high - low) * 0.08 || Math.abs(high) * 0.1 || 0.01;
  return [low - air, high + air];
};

function make(place, height, series, bands, scales, legend, unit = 's') {
  const options = {
    width: Math.max(place.clientWidth, 200), height, series: [{ label: unit, value }, ...series], bands, scales,
    legend: { show: legend }, cursor: { show: legend, y: false, points: { show: false }, drag: { x: false } },
    axes: [{ ...AXIS, size: 26 }, { ...AXIS, size: 58, space: 24, values: (u, v) => v.map((x) => number(x)) }],
    padding: [8, 8, 0, 0],
  };
  const plot = new uPlot(options, [[], ...series.map(() => [])], place);
  new ResizeObserver(() => plot.setSize({ width: Math.max(place.clientWidth, 200), height })).observe(place);
  return plot;
}

// Least and largest value of each block, filled between: nothing of a fast vibration is lost.
export function envelopes(place, height, colours) {
  const series = colours.flatMap((stroke) => [{ stroke, width: 1, points: { show: false } },
    { stroke, width: 1, points: { show: false } }]);
  const bands = colours.map((stroke, i) => ({ series: [2 * i + 2, 2 * i + 1], fill: `${stroke}55` }));
  const scales = { x: { time: false, range: (u, low, high) => [(high ?? 0) - WINDOW, high ?? 0] }, y: { range: airy } };
  return make(place, height, series, bands, scales, false);
}

// Lines over time; each with a band when `banded`.
export function histories(place, height, names, { banded = false, dashed = [] } = {}) {
  const series = [];
  const bands = [];
  names.forEach((label, i) => {
    const stroke = COLOURS[i % COLOURS.length];
    if (banded) {
      const edge = { stroke: `${stroke}00`, width: 0, points: { show: false }, label: '' };
      series.push({ ...edge, class: 'edge' }, { ...edge, class: 'edge' });
      bands.push({ series: [series.length, series.length - 1], fill: `${stroke}30` });
    }
    series.push({ label, stroke, width: 1.5, points: { size: 4 }, value,
      dash: dashed.includes(label) ? [5, 4] : undefined });
  });
  return make(place, height, series, bands, { x: { time: false }, y: { range: airy } }, true);
}

export function spectra(place, height, names, colours) {
  const series = names.map((label, i) => ({ label, stroke: colours[i], width: i ? 1.3 : 1, points: { show: false }, value }));
  const scales = { x: { time: false }, y: { distr: 3 } };
  return make(place, height, series, [], scales, true, 'Hz');
}
