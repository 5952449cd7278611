// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
// The parameters of one node, as its own descriptions say: type, unit, range, choices, whether it can change.

import { number } from './plots.js';

const cell = (text, name) => {
  const made = document.createElement('span');
  made.textContent = text;
  made.className = name;
  return made;
};

export class Parameters {
  constructor(send) {
    this.send = send;
    this.place = document.getElementById('parameters');
    this.node = document.getElementById('node');
    this.fixed = document.getElementById('fixed');
    this.found = [];
    this.node.onchange = () => this.ask();
    this.fixed.onchange = () => this.#show();
  }

  offer(names) {
    const listed = [...this.node.options].slice(1).map((option) => option.value);
    if (listed.join() === names.join()) return;
    const chosen = this.node.value;
    while (this.node.options.length > 1) this.node.remove(1);
    for (const name of names) this.node.add(new Option(name, name));
    this.node.value = names.includes(chosen) ? chosen : '';
  }

  ask() {
    this.place.replaceChildren();
    if (this.node.value) this.send({ do: 'parameters', node: this.node.value });
  }

  // Somebody has changed one: ask again, unless a person is typing here.
  changed(nodes) {
    if (nodes.includes(this.node.value) && !this.place.contains(document.activeElement)) {
      this.send({ do: 'parameters', node: this.node.value });
    }
  }

  take({ node, parameters }) {
    if (node !== this.node.value) return;
    this.found = parameters;
    this.#show();
  }

  #show() {
    // what has no description is ROS's own
    const shown = this.found.filter((parameter) => parameter.text && (this.fixed.checked || !parameter.fixed));
    this.place.replaceChildren(...shown.map((parameter) => this.#row(parameter)));
  }

  #row(parameter) {
    const row = document.createElement('label');
    row.className = 'parameter';
    row.dataset.parameter = parameter.name;
    const limits = [];
    const { rule } = parameter;
    if (parameter.low !== null && !rule.includes('above')) limits.push(`from ${number(parameter.low, 4)}`);
    if (rule && !rule.startsWith('one of')) limits.push(rule.replaceAll(';', ','));
    if (parameter.high !== null && !rule.includes('below')) limits.push(`to ${number(parameter.high, 4)}`);
    const text = `${parameter.text}${limits.length ? ` (${limits.join(', ')})` : ''}`;
    const [field, ...more] = this.#fields(parameter);
    row.append(cell(parameter.name, 'name'), field, cell(text, 'text'), ...more);
    return row;
  }

  #fields(parameter) {
    const { name, type, value, low, high, rule } = parameter;
    const set = (wanted) => this.send({ do: 'set', node: this.node.value, parameter: name, value: wanted });
    const input = document.createElement('input');
    input.disabled = parameter.fixed;
    if (type === 'bool') {
      input.type = 'checkbox';
      input.checked = value;
      input.onchange = () => set(input.checked);
      return [input];
    }
    if (type === 'string' && rule.startsWith('one of ')) {
      const select = document.createElement('select');
      for (const choice of rule.split(';')[0].slice(7).split(', ')) select.add(new Option(choice, choice));
      select.value = value;
      select.disabled = parameter.fixed;
      select.onchange = () => set(select.value);
      return [select];
    }
    if (type === 'integer' || type === 'double') {
      input.type = 'number';
      input.step = type === 'integer' ? 1 : 'any';
      if (low !== null) input.min = low;
      if (high !== null) input.max = high;
      input.value = value;
      const take = (text) => { if (text !== '' && Number.isFinite(Number(text))) set(Number(text)); };
      input.onchange = () => take(input.value);
      if (low === null || high === null || parameter.fixed) return [input];
      const slider = document.createElement('input');
      slider.type = 'range';
      slider.min = low;
      slider.max = high;
      slider.step = type === 'integer' ? 1 : (high - low) / 200;
      slider.value = value;
      slider.oninput = () => { input.value = Number(Number(slider.value).toPrecision(4)); };
      slider.onchange = () => take(input.value);
      return [input, slider];
    }
    input.type = 'text';
    input.value = Array.isArray(value) ? value.join(', ') : value ?? '';
    const items = () => input.value.split(',').map((item) => item.trim()).filter((item) => item !== '');
    const convert = { string: () => input.value, string_array: items, bool_array: () => items().map((i) => i === 'true') };
    input.onchange = () => set((convert[type] ?? (() => items().map(Number)))());
    return [input];
  }
}
