// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
// One strut: its card, and the data that its pictures are drawn from.

import { envelopes, number } from './plots.js';

const BLOCKS = 500;
const HISTORY = 300;
const UPPER = 0, LOWER = 1, ASKED = 2, APPLIED = 3;
const SILENT = 3000; // ms

const element = (kind, text = '', name = '') => {
  const made = document.createElement(kind);
  made.textContent = text;
  made.className = name;
  return made;
};

const history = (rows, more, most) => {
  for (const row of more) if (!rows.length || row[0] > rows.at(-1)[0]) rows.push(row);
  if (rows.length > most) rows.splice(0, rows.length - most);
};

export class Strut {
  constructor(name, place, send, choose) {
    this.name = name;
    this.card = element('article', '', 'strut');
    this.card.dataset.strut = name;
    this.parts = {};
    const top = element('div', '', 'top');
    top.append(element('h3', name.replaceAll('_', ' ')));
    for (const part of ['phase', 'law', 'trust']) top.append(this.parts[part] = element('span', '', 'chip'));
    top.append(this.parts.attenuation = element('span', '', 'attenuation'));
    this.parts.attenuation.title = 'Attenuation so far: running RMS now, against the last STANDBY; negative is better';
    this.card.append(top, this.parts.words = element('p', '', 'words'));
    this.acceleration = this.#plot('Acceleration, m/s²', ['upper', 'lower'], 130, ['#b08a3c', '#0b6fb8'], 'levels');
    this.voltage = this.#plot('Voltage, V', ['asked', 'applied'], 105, ['#7a3fa0', '#1d8a5a'], 'volts');
    const own = element('div', '', 'own');
    for (const [what, text] of [['stop', 'Stop'], ['reset', 'Reset']]) {
      const button = element('button', text, what === 'stop' ? 'stop' : '');
      button.onclick = () => send({ do: what, strut: name });
      own.append(button);
    }
    const detail = element('button', 'Details');
    detail.onclick = () => choose(name);
    own.append(detail);
    this.card.append(own);
    place.append(this.card);
    this.clear();
  }

  #plot(text, keys, height, colours, figures) {
    const caption = element('div', '', 'caption');
    caption.append(element('span', text));
    for (const key of keys) caption.append(this.parts[key] = element('span', key, `key ${key}`));
    caption.append(this.parts[figures] = element('b'));
    const place = element('div', '', height < 120 ? 'plot flat' : 'plot');
    this.card.append(caption, place);
    return { place, height, colours, made: null };
  }

  clear() {
    this.times = [];
    this.low = [[], [], [], []];
    this.high = [[], [], [], []];
    this.last = -1;
    this.gains = [];
    this.theta = [];
  }

  take(news) {
    if (news.run !== this.run || news.blocks.first > this.last + 1) this.clear();
    if (news.time !== this.news?.time) this.heard = performance.now();
    this.run = news.run;
    this.news = news;
    const { first, last, size, low, high } = news.blocks;
    // late voltages belong to blocks that are here already: they are put in again
    const again = this.times.length ? this.last + 1 - first : 0;
    if (again > 0) for (const row of [this.times, ...this.low, ...this.high]) row.splice(Math.max(row.length - again, 0));
    for (let block = first; block <= last; block += 1) {
      this.times.push((block + 0.5) * size * news.period);
      for (let column = 0; column < 4; column += 1) {
        this.low[column].push(low[column][block - first]);
        this.high[column].push(high[column][block - first]);
      }
    }
    this.last = last;
    const more = this.times.length - BLOCKS;
    if (more > 0) for (const row of [this.times, ...this.low, ...this.high]) row.splice(0, more);
    history(this.gains, news.gains, HISTORY);
    history(this.theta, news.theta, HISTORY);
  }

  draw() {
    // the later one is drawn on top
    for (const [plot, columns] of [[this.acceleration, [LOWER, UPPER]], [this.voltage, [ASKED, APPLIED]]]) {
      plot.made ??= envelopes(plot.place, plot.height, plot.colours);
      plot.made.setData([this.times, ...columns.flatMap((c) => [this.low[c], this.high[c]])]);
    }
    const { parts, news } = this;
    const { state, model } = news;
    const silent = performance.now() - this.heard > SILENT;
    this.card.classList.toggle('silent', silent);
    parts.phase.textContent = news.phase || 'no phase';
    parts.law.textContent = state.law || 'no controller';
    const trusted = model.converged;
    parts.trust.textContent = trusted === undefined ? 'no model' : trusted ? 'model trusted' : 'model not trusted';
    parts.trust.className = `chip ${trusted === undefined ? '' : trusted ? 'well' : 'warn'}`;
    parts.attenuation.textContent = news.attenuation === null ? '– dB' : `${news.attenuation.toFixed(1)} dB`;
    const words = silent ? ['no samples'] : [];
    if (state.fault) words.push(`FAULT, 0 V latched: ${state.reason || 'no reason given'}`);
    else if (state.reason) words.push(state.reason);
    if (news.applied && !words.includes(news.applied)) words.push(news.applied);
    if (trusted === false && model.reason) words.push(`model: ${model.reason}`);
    if (state.saturated) words.push('the guard limits the voltage');
    if ((news.nodes.voltage ?? []).length > 1) words.push(`${news.nodes.voltage.length} controllers on one strut`);
    parts.words.textContent = words.join('; ') || (state.law ? 'all is well' : '');
    parts.words.className = state.fault || news.applied.startsWith('0 V: latched') ? 'words bad' : 'words';
    parts.levels.textContent = `RMS ${number(news.level)}`;
    parts.volts.textContent = `law ${number(state.output)}, let through ${number(this.#newest(ASKED))}`;
    parts.applied.hidden = this.#newest(APPLIED) === null;
    this.card.dataset.voltage = this.#newest(ASKED);
  }

  #newest(column) {
    return this.high[column].findLast((v) => v !== null) ?? null;
  }
}
