// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
// One strut in detail: parameters with bands, gains, spectra, figures of model and controller.

import { histories, number, spectra } from './plots.js';

const HEIGHT = 210;
const GAINS = ['kp', 'ki', 'kd', 'ki_min', 'ki_max'];
const FACTS = [
  ['model', 'converged', 'model trusted'], ['model', 'reason', 'why not'], ['model', 'updates', 'samples used'],
  ['model', 'pole_modulus', 'largest pole modulus'], ['model', 'noise_variance', 'error variance, m²/s⁴'],
  ['model', 'response_deviation', 'relative deviation of the response'], ['model', 'model_error', 'error that the residual shows'],
  ['model', 'whiteness', 'whiteness of the error'], ['model', 'excitation_order', 'order of excitation'],
  ['state', 'law', 'law'], ['state', 'frequency', 'tracked frequency, Hz'], ['state', 'adapting', 'gains move'],
  ['state', 'saturated', 'guard limits'], ['state', 'missed_samples', 'samples lost'],
  ['state', 'compute_time', 'computing time of a sample, s'],
];

const columns = (rows, count) => Array.from({ length: count }, (_, i) => rows.map((row) => row[i] ?? null));

export class Detail {
  constructor() {
    this.plots = {};
    this.facts = document.getElementById('facts');
    this.name = '';
  }

  // The plot of a kind, made again when its curves are others.
  #plot(kind, key, make) {
    const place = document.getElementById(kind);
    if (this.plots[kind]?.key !== key) {
      this.plots[kind]?.plot.destroy();
      this.plots[kind] = { key, plot: make(place) };
    }
    return this.plots[kind].plot;
  }

  draw(strut) {
    const { news } = strut;
    const poles = (news.model.a ?? []).length;
    const count = poles + (news.model.b ?? []).length;
    const names = Array.from({ length: count }, (_, i) => (i < poles ? `a${i + 1}` : `b${i - poles + 1}`));
    const theta = this.#plot('theta', names.join(), (place) => histories(place, HEIGHT, names, { banded: true }));
    const rows = strut.theta.filter((row) => row[1].length === count);
    const bands = names.flatMap((_, i) => {
      const edge = (sign) => rows.map(([, v, s]) => (s[i] === null || s[i] === undefined ? null : v[i] + sign * 2 * s[i]));
      return [edge(-1), edge(1), rows.map(([, v]) => v[i])];
    });
    theta.setData([rows.map((row) => row[0]), ...bands]);

    const gains = this.#plot('gains', 'gains', (place) => histories(place, HEIGHT, GAINS, { dashed: ['ki_min', 'ki_max'] }));
    gains.setData(columns(strut.gains, 6));
    document.getElementById('no-gains').hidden = strut.gains.some((row) => row.slice(1, 4).some((v) => v !== null));

    const { frequency = [], upper = [], lower = [], before = [] } = news.spectra;
    const shown = ['lower plate', 'before control', 'upper plate now'];
    const spectrum = this.#plot('spectrum', 'spectra', (place) => spectra(place, HEIGHT, shown, ['#b08a3c', '#8794a0', '#0b6fb8']));
    // the mean is taken off, so the first line says nothing
    const positive = (values) => frequency.slice(1).map((_, i) => (values[i + 1] > 0 ? values[i + 1] : null));
    spectrum.setData([frequency.slice(1), positive(lower), positive(before.length ? before[1] : []), positive(upper)]);

    this.facts.replaceChildren(...FACTS.flatMap(([part, key, text]) => {
      const value = news[part][key];
      if (value === undefined || value === null || value === '') return [];
      const label = document.createElement('span');
      const shownValue = document.createElement('b');
      label.textContent = text;
      shownValue.textContent = typeof value === 'boolean' ? (value ? 'yes' : 'no') : typeof value === 'number' ? number(value, 4) : value;
      return [label, shownValue];
    }));
  }
}
