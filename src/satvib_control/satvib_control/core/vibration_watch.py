# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The last line of defence: a strut that is louder than its own open loop goes to 0 V, whatever the model says.

The watch knows one thing: the power of the strut's vibration, under the law and at 0 V. It uses no model, since a model
of the wrong phase explains what the law does as a growth of the disturbance. It knows no other strut either. The
struts shake each other, so all that are loud pause at about the same time, and come back one after another: a strut
that becomes loud while it comes back is itself the cause.

    base       power at 0 V: from STANDBY and CALIBRATE, and from each pause
    loud       power over `LEVEL_TIME` more than `watch_loudness` above the base, and not decaying (a shock decays)

| state | leaves when | next | voltage | learns |
|---|---|---|---|---|
| LISTENING | the law is let through (CONTROL) | ACTING | 0 V or excitation | the base, at 0 V |
| ACTING | loud for `PATIENCE`, nearly for `PATIENCE_NEAR`, or the base in doubt for long | PAUSING | the law's | - |
| PAUSING | the power no longer falls | WAITING if it fell by half, else RETURNING | fades to 0 | the base |
| WAITING | quiet for its turn, or 15 s more | RETURNING | 0 V | the base, after 15 s |
| PAUSING | the power has risen at once (a peek) | RETURNING | 0 V for `PEEK_TIME` | the base |
| RETURNING | loud for `PATIENCE_RETURNING`: a strike | PAUSING | fades in | - |
| RETURNING | `TURN` has passed | ACTING | the law's | - |

A pause in which the power does not fall by half says that the disturbance has grown: it becomes the base, and the law
goes on. A peek is shorter: where the level has changed slowly and the power rises as soon as the law is off, the law
had calmed it. It must fall again when the law is back; else the base is the one before, and a whole pause follows. A
strut that is itself the cause rarely sees its power rise by the pause. A strike resets the law and halves its
voltage; the third one is a fault. A second pause in which the power fell, of a strut that was not returning, is a
strike too: struts that are stable one by one can be unstable together. `FORGIVE_TIME` without a pause takes one
strike back.

The base in doubt. The open loop cannot be heard under the law. When the rig changes, it may fall, and then a strut can
be far louder than its open loop and yet quieter than its base. Such a change shows: the level under control becomes
another one. From then on the doubt grows, with the ratio of amplitudes q = sqrt(level / base), until it reaches
`DOUBT`; then a pause hears the open loop. So the cost stays small: a pause at a level far below the base is dear, and
comes late; one near the base costs nothing, and comes soon. Where the power rises at once, the law is not the cause,
and the doubt is over until the level changes again. Such a pause alone is no strike, for random vibration may fall by
itself: it gives the true base, and a law that is the cause is then loud, RETURNING or ACTING. A level that falls is in
no doubt. A peek that has raised the base may have heard a mode that rings, so its base is in doubt at once.

How long a strut can be loud, more than 6 dB above the true open loop O, with the base B and a loudness of 4 dB:

    O > 0.63 B   the level is above the limit: 0.3 s until it is found, `PATIENCE`, 0.1 s of fade: 1.4 s
    O < 0.63 B   q > 2 sqrt(O / B): `DOUBT` / q = sqrt(B / O) s, which is below 4 s down to O = B / 16

and 0.5 s of ringing; twice as long, and so on up to eight times, where earlier pauses at about the same level have
shown that the law calms.

Between the samples. The watch hears samples, and a staircase of voltages also shakes the strut between them: its images
at the sample rate plus and minus the tone. On `paper_3dof`, at 100 Hz, they carry up to 4 dB of the true level that no
sample shows, and a strut 6.9 dB too loud was heard at 3.8 dB, near the limit, for seconds. So 2 dB less than loud is
nearly loud, and its time is summed over RETURNING and ACTING: 0.3 s, `PATIENCE_NEAR`, 0.1 s and 0.5 s of ringing are
3.9 s, where the level is heard 3 dB above the base. Samples give no bound for the hidden part: motion that is zero at
every sample may have any power. The short base of a pause may be 1 dB wrong, so 3 dB of hidden level are covered, no
more: a strut that is heard less than 3 dB above its base can be truly louder than 6 dB, and is not found.

What is not found in 5 s: an open loop that falls by more than 12 dB under a law whose level
stays far below the base (up to 9 s, and never where it is 13 dB below); one that falls while the level under control
does not change by 1.8 dB; one under a level that falls by 1 dB/s again and again. No law without an excitation of its
own can tell these from a law that calms.
"""

import numpy as np
from satvib_common.arrays import Array, Integers, Mask, every

from satvib_control.core.parameters import CoreParameters
from satvib_control.core.vibration_memory import (
    Verdict,
    forgive,
    fresh_memory,
    is_back,
    is_off,
    is_reduced,
    settings_of,
)
from satvib_control.core.vibration_step import watch_step

__all__ = ['Verdict', 'VibrationWatch']


class VibrationWatch:
    """Watches the vibration of each strut under its law; see the module's page.

    Args:
        parameters: of the controller.
        dt: s.
        shape: leading axes; the last one, when there is one, counts struts.
    """

    in_turn = True  # the struts come back one after another

    def __init__(self, parameters: CoreParameters, dt: float, shape: tuple[int, ...] = ()) -> None:
        self.shape, self.limit = shape, parameters.voltage_limit
        order = np.zeros(shape)
        if self.in_turn:
            order = order + parameters.strut + (np.arange(shape[-1]) if shape else 0)
        ratio = 10.0 ** (0.1 * parameters.watch_loudness)
        self._settings = settings_of(dt, parameters.watch_floor, ratio, order)
        self._memory = fresh_memory(shape)
        self.busy = False  # some law is taken off or has less than its own voltage

    def step(self, y: Array, applied: Array, acting: bool, silent: bool) -> tuple[Array, Integers]:
        """Judge a sample.

        Args:
            y: shape, m/s^2, without bias.
            applied: shape, V; in force before this sample.
            acting: the law's voltage is let through in this phase.
            silent: no strut is excited on purpose in this phase, so that the base can be learnt.

        Returns:
            (shape) share of the law's voltage to let through; (shape) the `Verdict`.
        """
        share, verdict = watch_step(
            y, applied / self.limit, float(acting), float(silent), self._settings, self._memory
        )
        self.busy = not every(is_back(self._memory))
        return np.asarray(share), np.asarray(verdict).astype(np.int64)

    def listening(self) -> Mask:
        """Where (shape) the law is taken off at the moment."""
        return is_off(self._memory)

    def reduced(self) -> Mask:
        """Where (shape) the law has less than its own voltage."""
        return is_reduced(self._memory)

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget strikes and pauses where (shape) `mask` holds."""
        forgive(self._memory, np.broadcast_to(np.asarray(mask), self.shape))
