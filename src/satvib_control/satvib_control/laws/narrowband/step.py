# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample of law narrowband: disturbance observer, tones, voltage, back-off, margin; see `law`."""

import math

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.direct_form import filter_sample

from satvib_control.laws.narrowband.backoff import Verdict, restart, rung_down, watch
from satvib_control.laws.narrowband.margin import stretch
from satvib_control.laws.narrowband.memory import (
    Backoff,
    Design,
    Floor,
    Memory,
    Past,
    Ring,
    Sample,
    Setting,
    Shown,
    Tone,
    Tracking,
)
from satvib_control.laws.narrowband.model_correction import (
    begin_attempt,
    correct_model,
    corrected,
    learn,
    no_attempt,
    turned,
)
from satvib_control.laws.narrowband.proof import prove
from satvib_control.laws.narrowband.search import LOOKS_PER_WINDOW, search
from satvib_control.laws.narrowband.tracker import correct, lost, predict, prune
from satvib_control.laws.narrowband.voltage import ask, fade, limit_volts, note


@njit
def one_sample(design, memory, sample, shown):
    """Give the voltage of one sample of one item; `memory` and `shown` (Shown) are changed."""
    settings, backoff = design.settings, memory.backoff
    d = _disturbance(design, memory, sample.applied, sample.y)
    error, looked, out_of_track = _track(settings, memory, d, sample.valid)
    demand, omega, tracking = ask(design, memory)
    short = limit_volts(demand, settings[Setting.VOLTAGE])
    held = _back_off(settings, memory, sample, d, omega, out_of_track)
    act = sample.act and not held
    _learn_from_attempt(settings, memory, sample, act, omega, d)
    if sample.valid and act:
        prove(memory, settings, demand.share, sample.y)
    u = fade(settings, memory, demand, act)
    if looked:
        stretch(design, memory, demand.inverse)
    note(demand, memory)
    shown[Shown.ERROR] = error
    shown[Shown.OMEGA] = omega if omega > 0.0 else np.nan
    shown[Shown.VOLTS] = backoff[Backoff.VOLTS]
    shown[Shown.SENSITIVITY] = memory.tracking[Tracking.SENSITIVITY]
    shown[Shown.TRACKING] = 1.0 if tracking else 0.0
    shown[Shown.LIMITED] = 1.0 if short else 0.0
    shown[Shown.HELD] = 1.0 if held else 0.0
    shown[Shown.SLOWED] = 1.0 if memory.tracking[Tracking.STRETCH] > 1.0 else 0.0
    return u


@njit
def _disturbance(design, memory, applied, y):
    """Give d = y - G u: step the model by the voltage of the sample before; its first coefficient is 0."""
    filter_sample(design.b, design.a, memory.model, applied)
    return y - corrected(memory.correction, memory.model[0])


@njit
def _track(settings, memory, d, valid):
    """Take a sample of the disturbance; give the error, whether tones were searched, whether the tracker was lost."""
    tracking, tones, rings = memory.tracking, memory.tones, memory.rings
    window = rings.shape[1]
    step = math.pi / window
    expected = predict(tones)
    if not valid:
        return 0.0, False, False
    e = d - expected
    correct(tones, settings, tracking, memory.floor[Floor.NOISE], step, e)
    pointer = int(tracking[Tracking.POINTER])
    rings[Ring.ERROR, pointer] = e
    rings[Ring.DISTURBANCE, pointer] = d
    tracking[Tracking.POINTER] = float((pointer + 1) % window)
    tracking[Tracking.SEEN] += 1.0
    out_of_track = lost(tracking, settings, e, d)
    if out_of_track:
        tracking[Tracking.BAD_SAMPLES] = 0.0
        tracking[Tracking.TOP] = 0.0
        rings[Ring.ERROR, :] = rings[Ring.DISTURBANCE, :]
        tones[:, Tone.ON] = 0.0
    between = max(window // LOOKS_PER_WINDOW, 1)
    seen = tracking[Tracking.SEEN]
    looked = seen >= window and int(seen) % between == 0
    if looked:
        prune(tones, settings, memory.floor[Floor.NOISE], step, window)
        search(tones, settings, tracking, rings[Ring.ERROR], memory.floor, step)
    return e, looked, out_of_track


@njit
def _back_off(settings, memory, sample, d, omega, out_of_track):
    """Whether the law is held at 0 V; tones are searched again when a hold begins, the model corrected at its end."""
    backoff = memory.backoff
    if not sample.valid:
        return backoff[Backoff.HOLD] > 0.0
    wrong = out_of_track and turned(memory.correction)
    y = sample.y
    verdict = watch(backoff, memory.tracking, settings, y, y - d, sample.act, wrong)
    if verdict == Verdict.TAKEN_OFF and backoff[Backoff.BRIEF] == 0.0:
        memory.tones[:, Tone.ON] = 0.0
    if verdict == Verdict.CAUSED and correct_model(memory.correction, omega):
        restart(backoff, settings)
    return verdict == Verdict.TAKEN_OFF or verdict == Verdict.HELD


@njit
def _learn_from_attempt(settings, memory, sample, act, omega, d):
    """An attempt begins after quiet; from then on every sample of it shows something of the plant."""
    quiet = no_attempt(memory.correction) or rung_down(memory.backoff, settings[Setting.PACE])
    if act and omega > 0.0 and quiet:
        begin_attempt(memory.correction, omega)
    elif sample.valid and act:
        learn(memory.correction, settings, omega, sample.y, sample.y - d)


# b, a, settings, points, weights; model, tracking, backoff, correction, tones, rings, floor
ITEM = (
    'f8[:], f8[:], f8[:], f8[:,:], f8[:,:], f8[:], f8[:], f8[:], f8[:], f8[:,:], f8[:,:], f8[:,:]'
)
LAYOUT = '(m),(m),(p),(q,r),(x,y),(k),(c),(h),(e),(t,s),(z,w),(f,g)'
WRITABLE = (*Memory._fields, 'shown')


@kernel(f'void({ITEM}, f8, f8, f8, f8, f8[:], f8[:])', f'{LAYOUT},(),(),(),(),(o)->()', WRITABLE)
def narrowband_step(
    b, a, settings, points, weights, model, tracking, backoff, correction, tones, rings, floor,
    y, applied, valid, act, shown, u,
):  # fmt: skip
    """Give the voltage of one sample; see `Sample`. `valid`: 1, 0, or -1 where there is no model: nothing is done."""
    if valid < 0.0:
        u[0] = 0.0
        return
    design = Design(b, a, settings, points, weights)
    memory = Memory(model, tracking, backoff, correction, tones, rings, floor)
    u[0] = one_sample(design, memory, Sample(y, applied, valid > 0.0, act > 0.0), shown)


@kernel(f'void({ITEM}, f8[:,:], f8, f8, f8[:], f8[:])', f'{LAYOUT},(l,v),(),(),(o)->()', WRITABLE)
def narrowband_replay(
    b, a, settings, points, weights, model, tracking, backoff, correction, tones, rings, floor,
    past, oldest, follow, shown, done,
):  # fmt: skip
    """Run over the past.

    Args:
        past: (l, Past); `oldest` is the place of its oldest row.
        follow: 1: model and tones, 0: the model alone, -1: nothing.
        done: out, samples run.
    """
    design = Design(b, a, settings, points, weights)
    memory = Memory(model, tracking, backoff, correction, tones, rings, floor)
    length = past.shape[0]
    done[0] = 0.0
    for i in range(length):
        row = past[(int(oldest) + i) % length]
        if row[Past.VALID] < 0.0 or follow < 0.0:
            continue
        if follow > 0.0:
            # nothing is learnt there of the strut at 0 V: the others may have been excited
            backoff[Backoff.VOLTS] = 1.0
            # `follow > 1` is False, of the type that the step has
            sample = Sample(row[Past.UPPER], row[Past.APPLIED], row[Past.VALID] > 0.0, follow > 1.0)
            one_sample(design, memory, sample, shown)
        else:
            _disturbance(design, memory, row[Past.APPLIED], row[Past.UPPER])
        done[0] += 1.0
