# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of docs/soak.md."""

from soaking import Growth, Soak

KINDS = {True: 'realtime', False: 'lockstep'}
_HEAD = (
    '| process | RSS | RSS an hour | PSS | PSS an hour | own an hour | 95 % | descriptors |\n'
    '|---|---:|---:|---:|---:|---:|---:|---:|'
)


def marks(realtime: bool) -> tuple[str, str]:
    """Where a table begins and ends."""
    kind = KINDS[realtime]
    return f'<!-- {kind}: written by benchmarks/soak.py -->', f'<!-- end of {kind} -->'


def _row(name: str, growth: Growth) -> str:
    first, last, (middle, low, high) = growth.first, growth.last, growth.private
    cells = [
        name, f'{last.resident:.1f} MB', f'{growth.resident[0]:+.2f} MB', f'{last.share:.1f} MB',
        f'{growth.share[0]:+.2f} MB', f'{middle:+.2f} MB', f'{low:+.2f} to {high:+.2f}',
        f'{first.descriptors}, {last.descriptors}',
    ]  # fmt: skip
    return f'| {" | ".join(cells)} |'


def text_of(found: Soak, minutes: float, scenario: str, composition: str) -> str:
    """Give the figures of a run as Markdown."""
    outcome, (first, last) = found.outcome, found.speed
    lines = [
        (
            f'`{scenario}`, composition `{composition}`, {outcome["samples"]} samples of '
            f'{outcome["struts"]} struts ({minutes:g} minutes at {outcome["rate"]:g} Hz) in '
            f'{outcome["wall_time"] / 60.0:.1f} minutes; bag {outcome["bag"] / 1e6:.0f} MB.'
        ),
        '',
        f'- Samples and voltages lost: {outcome["lost"]}. The run: {outcome["message"]}.',
    ]
    if found.late is not None and found.latency is not None:
        late, missed, samples = found.late
        lines += [
            f'- Late: {late} voltages after the next sample was due, {missed} that never came, {samples} samples.',
            '- Latency from a sample to its voltage, 50th and 99th percentile: first tenth {:.2f} and {:.2f} ms, last '
            'tenth {:.2f} and {:.2f} ms.'.format(*found.latency),
        ]
    lines += [
        f'- Speed: {first:.0f} samples a second in the first tenth, {last:.0f} in the last.',
        f'- Files in shared memory: {max(g.last.shared for g in found.processes.values())}.',
        '',
        _HEAD,
    ]
    return '\n'.join(lines + [_row(n, g) for n, g in sorted(found.processes.items())])


def write(page: str, realtime: bool, text: str) -> str:
    """Give the page with new figures of one kind of run."""
    begin, end = marks(realtime)
    return f'{page.split(begin)[0]}{begin}\n\n{text}\n\n{end}{page.split(end)[1]}'
