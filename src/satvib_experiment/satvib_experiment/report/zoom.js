// SPDX-FileCopyrightText: 2026 The satvib authors
// SPDX-License-Identifier: Apache-2.0
// Samples to zoom into: the wheel zooms, a drag selects, a double click shows all. All panels share one time.
(() => {
  const about = JSON.parse(document.getElementById('samples').textContent);
  const numbers = (text, scale) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    return Float32Array.from(new Int16Array(bytes.buffer), (v) => (v === -32768 ? NaN : v * scale));
  };
  const end = about.start + about.period * about.count;
  let range = [about.start, end], drag = null;
  const panels = about.panels.map((panel) => ({
    ...panel,
    data: panel.series.map((s) => numbers(s, panel.scale)),
    canvas: document.getElementById(`zoom-${panel.name}`),
  }));
  const left = 58, right = 8, top = 8, bottom = 26;

  const step = (span, most) => {
    const raw = span / most, power = 10 ** Math.floor(Math.log10(raw));
    return power * [1, 2, 5, 10].find((f) => f * power >= raw);
  };
  const ticks = (low, high, most) => {
    const by = step(high - low, most), found = [];
    for (let v = Math.ceil(low / by) * by; v <= high + 1e-9 * by; v += by) found.push(v);
    const digits = Math.max(0, -Math.floor(Math.log10(by) + 1e-9));
    return found.map((v) => [v, v.toFixed(Math.min(digits, 6))]);
  };

  function draw(panel) {
    const { canvas, data, colors, unit } = panel;
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const ink = canvas.getContext('2d');
    ink.scale(ratio, ratio);
    const first = Math.max(Math.floor((range[0] - about.start) / about.period), 0);
    const last = Math.min(Math.ceil((range[1] - about.start) / about.period), about.count - 1);
    let low = Infinity, high = -Infinity;
    for (const values of data) {
      for (let k = first; k <= last; k++) {
        if (values[k] < low) low = values[k];
        if (values[k] > high) high = values[k];
      }
    }
    if (!(high > low)) [low, high] = Number.isFinite(low) ? [low - 1, low + 1] : [-1, 1];
    const margin = 0.05 * (high - low);
    low -= margin;
    high += margin;
    const x = (t) => left + ((t - range[0]) / (range[1] - range[0])) * (width - left - right);
    const y = (v) => top + ((high - v) / (high - low)) * (height - top - bottom);
    ink.font = '11px sans-serif';
    ink.strokeStyle = '#dddddd';
    ink.fillStyle = '#666666';
    ink.lineWidth = 1;
    ink.textAlign = 'center';
    for (const [t, text] of ticks(range[0], range[1], 8)) {
      ink.beginPath(); ink.moveTo(x(t), top); ink.lineTo(x(t), height - bottom); ink.stroke();
      ink.fillText(`${text} s`, x(t), height - bottom + 15);
    }
    ink.textAlign = 'right';
    for (const [v, text] of ticks(low, high, 5)) {
      ink.beginPath(); ink.moveTo(left, y(v)); ink.lineTo(width - right, y(v)); ink.stroke();
      ink.fillText(text, left - 5, y(v) + 4);
    }
    ink.textAlign = 'left';
    ink.fillText(unit, 2, top + 10);
    ink.save();
    ink.beginPath(); ink.rect(left, top, width - left - right, height - top - bottom); ink.clip();
    const dense = (last - first) / (width - left - right);
    data.forEach((values, i) => {
      ink.strokeStyle = ink.fillStyle = colors[i];
      ink.beginPath();
      for (let k = first; k <= last; ) {
        const next = dense > 2 ? Math.min(k + Math.floor(dense), last + 1) : k + 1;
        let least = Infinity, most = -Infinity;
        for (let j = k; j < next; j++) {
          if (values[j] < least) least = values[j];
          if (values[j] > most) most = values[j];
        }
        const at = x(about.start + k * about.period);
        if (least <= most) {
          ink.lineTo(at, y(most));
          if (least < most) ink.lineTo(at, y(least));
          if (dense < 0.2) ink.fillRect(at - 2, y(most) - 2, 4, 4);
        }
        k = next;
      }
      ink.stroke();
    });
    if (drag) {
      ink.fillStyle = 'rgba(0, 114, 178, 0.15)';
      ink.fillRect(Math.min(x(drag[0]), x(drag[1])), top, Math.abs(x(drag[1]) - x(drag[0])), height - top - bottom);
    }
    ink.restore();
  }
  const drawAll = () => panels.forEach(draw);
  const show = (from, to) => {
    const shortest = 4 * about.period;
    if (to - from < shortest) to = from + shortest;
    range = [Math.max(from, about.start), Math.min(to, end)];
    if (range[1] - range[0] < shortest) range = [about.start, end];
    drawAll();
  };
  for (const panel of panels) {
    const { canvas } = panel;
    const time = (event) => {
      const box = canvas.getBoundingClientRect();
      const share = (event.clientX - box.left - left) / (box.width - left - right);
      return range[0] + Math.min(Math.max(share, 0), 1) * (range[1] - range[0]);
    };
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const t = time(event), factor = Math.exp(0.002 * event.deltaY);
      show(t - (t - range[0]) * factor, t + (range[1] - t) * factor);
    }, { passive: false });
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      drag = [time(event), time(event)];
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!drag) return;
      drag[1] = time(event);
      drawAll();
    });
    canvas.addEventListener('pointerup', () => {
      const chosen = drag;
      drag = null;
      if (chosen && Math.abs(chosen[1] - chosen[0]) > 2 * about.period) show(Math.min(...chosen), Math.max(...chosen));
      else drawAll();
    });
    canvas.addEventListener('dblclick', () => show(about.start, end));
  }
  window.addEventListener('resize', drawAll);
  drawAll();
})();
