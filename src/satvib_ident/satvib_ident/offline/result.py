# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an offline identification found: the candidates, the one chosen, and what speaks for and against it."""

from dataclasses import dataclass
from enum import Enum

from satvib_common.arrays import Array

from satvib_ident.models.iir_model import IirModel
from satvib_ident.offline.residuals import ResidualTests


class Offset(Enum):
    """What is done about signals that do not swing about zero."""

    NONE = 'as measured'
    MEANS = 'means removed'
    CONSTANT = 'constant term'


class Finding(Enum):
    """What was found about a model; the value says what to do, `trusted` whether the model may still be trusted."""

    PURE_FEEDBACK = (
        False,
        'excite the loop with a signal that does not depend on the output (a dither)',
    )
    POOR_EXCITATION = (
        False,
        'excite with a PRBS, a multisine or a chirp, or ask for a lower --order',
    )
    ALL_UNSTABLE = (False, 'take trend and offset off, ask for other orders, or excite more')
    UNSTABLE_IN_LOOP = (
        False,
        'add a dither, and judge the model by its one-step fit and by a test in the loop: its free run says nothing',
    )
    SWAPPED = (
        False,
        'swap --input and --output; if a controller dominates the record, excite the loop more',
    )
    NO_RESPONSE = (False, 'check the columns, give a larger --delay, or excite more')
    FREE_RUN_FAILS = (
        False,
        'try other orders, another --delay or --method instrumental; look at the notes',
    )
    FEW_SAMPLES = (False, 'look at these samples, and mark wrong ones as missing (an empty cell)')
    RESIDUAL_ANSWERS = (False, 'raise --order or --coefficients, or give the --delay')
    EXACT_FIT = (
        True,
        'a measured record has noise: make sure that the output was not computed from the input',
    )
    FEEDBACK = (
        True,
        'if a controller was running, least squares may be biased: excite with a dither',
    )
    RESIDUAL_HINT = (True, 'a higher --order may fit better')

    @property
    def trusted(self) -> bool:
        """Whether a model with this finding may be trusted."""
        return self.value[0]

    @property
    def advice(self) -> str:
        """What to do."""
        return self.value[1]


@dataclass(frozen=True)
class Found:
    """A finding and the figures behind it."""

    finding: Finding
    evidence: str

    def __str__(self) -> str:
        """The whole sentence."""
        return f'{self.finding.name}: {self.evidence}; {self.finding.advice}'


@dataclass(frozen=True, eq=False)
class Candidate:
    """One order and what it achieves.

    Attributes:
        model: estimated on the whole record.
        standard_deviation: (p) of a, b.
        noise_variance: of the one-step errors.
        aic, bic: information criteria over the samples that all candidates share.
        one_step, free_run: fits over the whole record.
        validation_one_step, validation_free_run: fits over the validation part of the model of the first part.
        constant: c of A(q) y = B(q) u + c, in the unit of the output.
    """

    model: IirModel
    standard_deviation: Array
    noise_variance: float
    aic: float
    bic: float
    one_step: float
    free_run: float
    validation_one_step: float
    validation_free_run: float
    constant: float = 0.0

    @property
    def parameters(self) -> int:
        """Number of parameters, n + m."""
        return self.model.theta.shape[-1]

    @property
    def memory(self) -> int:
        """Samples before a prediction that it needs."""
        return max(self.model.order, self.model.b.shape[-1] - 1 + self.model.delay)

    @property
    def name(self) -> str:
        """'n/m' and the delay where there is one."""
        late = f', delay {self.model.delay}' if self.model.delay else ''
        return f'{self.model.order}/{self.model.b.shape[-1]}{late}'


@dataclass(frozen=True, eq=False)
class OfflineResult:
    """What `identify` found.

    Attributes:
        candidates: in the order asked for.
        chosen: the one that `reason` speaks of.
        reason: why it was chosen, a sentence.
        offset: what was done about offsets.
        notes: what was compared and what was left out, a sentence each.
        findings: what speaks for and against the model, the gravest first.
        tests: correlations of its residual over the whole record.
        y, u: the record as used, (samples); NaN where a sample is missing.
        predicted, free: one-step predictions and free run of the chosen model, (samples); NaN where there are none.
        split: first sample of the validation part.
        method: how it was estimated.
    """

    candidates: tuple[Candidate, ...]
    chosen: Candidate
    reason: str
    offset: Offset
    notes: tuple[str, ...]
    findings: tuple[Found, ...]
    tests: ResidualTests
    y: Array
    u: Array
    predicted: Array
    free: Array
    split: int
    method: str

    @property
    def model(self) -> IirModel:
        """The chosen model."""
        return self.chosen.model

    @property
    def residual(self) -> Array:
        """One-step errors of the chosen model, (samples); NaN where there are none."""
        return self.y - self.predicted

    @property
    def trusted(self) -> bool:
        """Whether nothing that was found forbids to use the model."""
        return all(found.finding.trusted for found in self.findings)

    def about(self) -> dict[str, float | int | str | bool | list[str]]:
        """Plain data for the model's file."""
        return {
            'method': self.method,
            'samples': len(self.y),
            'chosen because': self.reason,
            'offset': self.offset.value,
            'constant': self.chosen.constant,
            'one-step fit': self.chosen.one_step,
            'free-run fit': self.chosen.free_run,
            'noise variance': self.chosen.noise_variance,
            'trusted': self.trusted,
            'findings': [str(found) for found in self.findings],
        }
