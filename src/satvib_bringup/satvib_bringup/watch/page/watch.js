// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
// The page: a WebSocket to the server that it came from, and what is drawn of its messages.

import { Detail } from './detail.js';
import { Parameters } from './parameters.js';
import { Strut } from './strut.js';

const LINES = 50;
const LEVELS = ['well', 'warn', 'bad', '', ''];
const LEVEL_WORDS = ['well', 'complains', 'FAULT', 'not active', 'gone'];
const by = (id) => document.getElementById(id);

const struts = new Map();
const detail = new Detail();
let socket = null;
let recording = '';

const send = (request) => { if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(request)); };
const parameters = new Parameters(send);

by('stop').onclick = () => send({ do: 'stop' });
by('reset').onclick = () => send({ do: 'reset' });
by('arm').onclick = () => {
  if (confirm('Voltages will reach the hardware, and metal will move. Arm?')) send({ do: 'arm' });
};
by('record').onclick = () => send({ do: 'record', on: !recording });
by('chosen').onchange = () => drawAll();

const choose = (name) => {
  by('chosen').value = name;
  drawAll();
  by('detail').scrollIntoView({ behavior: 'smooth' });
};

function drawAll() {
  if (document.hidden) return;
  for (const strut of struts.values()) strut.draw();
  const chosen = struts.get(by('chosen').value);
  if (chosen?.news) detail.draw(chosen);
}

function takeStruts(news) {
  for (const one of news) {
    if (!struts.has(one.name)) {
      struts.set(one.name, new Strut(one.name, by('struts'), send, choose));
      by('chosen').add(new Option(one.name, one.name));
      by('struts').append(...[...by('struts').children].sort((a, b) => (a.dataset.strut < b.dataset.strut ? -1 : 1)));
    }
    struts.get(one.name).take(one);
  }
}

function showNodes(nodes) {
  by('nodes').tBodies[0].replaceChildren(...nodes.map((node) => {
    const row = document.createElement('tr');
    const figures = Object.entries(node.figures).map(([key, value]) => `${key} ${value}`).join(', ');
    for (const text of [node.name, LEVEL_WORDS[node.level], node.text, figures]) row.insertCell().textContent = text;
    const chip = document.createElement('span');
    chip.className = `chip ${LEVELS[node.level]}`;
    chip.textContent = LEVEL_WORDS[node.level];
    row.cells[1].replaceChildren(chip);
    return row;
  }));
}

function addLines(lines) {
  for (const line of lines) {
    const item = document.createElement('li');
    const time = document.createElement('time');
    time.textContent = line.time;
    item.append(time, line.text);
    item.className = line.kind;
    by('lines').prepend(item);
  }
  while (by('lines').children.length > LINES) by('lines').lastChild.remove();
}

function take(message) {
  if (message.kind === 'parameters') {
    parameters.take(message);
    return;
  }
  if (message.kind === 'whole') {
    by('lines').replaceChildren();
    for (const strut of struts.values()) strut.clear();
  }
  takeStruts(message.struts);
  const nodes = new Set(message.struts.flatMap((strut) => Object.values(strut.nodes).flat()));
  parameters.offer([...nodes].sort());
  parameters.changed(message.changed ?? []);
  showNodes(message.nodes);
  addLines(message.lines);
  recording = message.recording;
  by('record').textContent = recording ? 'End the recording' : 'Record';
  by('record').classList.toggle('on', Boolean(recording));
  by('arm').hidden = !message.armable;
  by('scenario').textContent = message.scenario || (struts.size ? 'no scenario' : 'no graph is heard yet');
  const times = message.struts.map((strut) => strut.time ?? 0);
  by('clock').textContent = times.length ? `${Math.max(...times).toFixed(1)} s of the run` : '';
  drawAll();
}

function connect() {
  socket = new WebSocket(`ws://${location.host}/live`);
  socket.onopen = () => { by('lost').hidden = true; };
  socket.onmessage = (event) => take(JSON.parse(event.data));
  socket.onclose = () => {
    by('lost').hidden = false;
    setTimeout(connect, 1000);
  };
}

document.onvisibilitychange = drawAll;
connect();
