# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an evaluation says, against signals whose levels are known in closed form."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_experiment.analysis.analysis import analyse
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.analysis.notes import notes_for
from satvib_experiment.analysis.tones import disturbance_onset, disturbance_tones
from satvib_experiment.analysis.windows import find_windows
from satvib_experiment.scenario.scenario import load_scenario
from satvib_plant_sim.disturbance import make_disturbance

DT, FINE = 0.01, 40
SAMPLES = 1000
T = np.arange(SAMPLES) * DT
TF = (T[:, None] + np.arange(FINE) * DT / FINE)[:, None, :]
SCENARIO = load_scenario(
    'paper_3dof',
    ['duration=10', 'disturbance.start=0', 'phases=[{phase: STANDBY}, {phase: CONTROL, start: 5}]',
     'analysis={uncontrolled: [1, 5], controlled: [7, 10]}', 'rig=paper_1dof',
     'rig.acquisition.sample_rate=100'],
)  # fmt: skip


def gain(t, after):
    """1 before 5 s, `after` from there on."""
    return np.where(t < 5.0, 1.0, after)


def run(synthetic, measured, true):
    """A strut whose 10 Hz tone falls to `measured` in the samples and to `true` between them, at 5 s."""
    upper = (gain(T, measured) * np.sin(2 * np.pi * 10 * T) + 0.4)[:, None]
    fine = gain(TF, true) * np.sin(2 * np.pi * 10 * TF)
    made = synthetic(upper, true=fine)
    made.scenario, made.rig = SCENARIO, SCENARIO.load_rig()
    return made


def test_attenuations_of_a_known_fall(synthetic):
    """Closed form: a tenth is -20 dB, a hundredth -40 dB, in RMS and at the tone, whatever the bias; 1e-9 dB."""
    e = evaluate(run(synthetic, 0.01, 0.1))
    assert e.frequencies == (10.0,)
    for kind, wanted in (('measured', -40.0), ('true', -20.0)):
        assert e.attenuation[f'{kind}_rms'][0] == pytest.approx(wanted, abs=1e-9)
        assert e.attenuation[f'{kind}_tone'][0] == pytest.approx(wanted, abs=1e-9)
    assert e.levels['uncontrolled']['true_tone'][0] == pytest.approx(1.0, abs=1e-9)
    assert e.levels['uncontrolled']['true_rms'][0] == pytest.approx(np.sqrt(0.5), abs=1e-9)
    assert np.isnan(e.attenuation_open_loop['true_rms'][0])


def test_the_floor_is_the_noise_of_the_rig_against_the_level(synthetic):
    """Truth: the plant's own figure of its sensor noise, put into Eq. (42) by hand."""
    from satvib_plant_sim.physics.noise import noise_floor

    e = evaluate(run(synthetic, 0.5, 0.5))
    noise = noise_floor(SCENARIO.load_rig())
    assert e.floor['measured_rms'][0] == pytest.approx(
        20 * np.log10(noise / np.sqrt(0.5)), abs=1e-9
    )
    tone = noise * np.sqrt(4 / 300)
    assert e.floor['measured_tone'][0] == pytest.approx(20 * np.log10(tone), abs=1e-9)


def test_a_loop_that_fools_itself_is_told_on(synthetic):
    """Truth: 20 dB apart needs the sentence, 2 dB apart does not."""
    fooled = run(synthetic, 0.01, 0.1)
    notes = notes_for(fooled, evaluate(fooled))
    assert any('differ by more than 3 dB' in n and '-40.0 dB measured' in n for n in notes)
    assert any('more attenuation than there is' in n for n in notes)
    honest = run(synthetic, 0.1, 0.125)
    assert not any('differ' in n for n in notes_for(honest, evaluate(honest)))


def test_a_worse_payload_is_told(synthetic):
    """Truth: twice the level is +6.0 dB."""
    worse = run(synthetic, 0.5, 2.0)
    assert any('worse at strut 1 (by up to 6.0 dB' in n for n in notes_for(worse, evaluate(worse)))


def test_the_open_loop_twin_is_the_baseline_in_the_same_instants(synthetic):
    """A disturbance that grows fourfold by itself. Truth: against before +6 dB, against the twin -6 dB."""
    grown = run(synthetic, 2.0, 2.0)
    twin = run(synthetic, 4.0, 4.0)
    e = evaluate(grown, twin)
    assert e.attenuation['true_rms'][0] == pytest.approx(20 * np.log10(2), abs=1e-9)
    assert e.attenuation_open_loop['true_rms'][0] == pytest.approx(-20 * np.log10(2), abs=1e-9)
    louder = evaluate(grown, run(synthetic, 1.0, 1.0))
    assert louder.largest_amplification[0] == pytest.approx(20 * np.log10(2), abs=1e-9)


def test_settling_time_of_an_exponential_fall(synthetic):
    """From 5 s on the level falls as exp(-t/tau) to 0.01, tau 0.25 s. Truth: 3 dB above the end is reached when
    exp(-t/tau) = 0.01 (10^0.15 - 1) = 0.0041, t = 5.49 tau = 1.37 s; the window of the moving RMS (0.25 s) and the
    period of the tone add to it, so 1.37 to 1.75 s.
    """
    envelope = np.where(TF < 5.0, 1.0, 0.01 + 0.99 * np.exp(-(TF - 5.0) / 0.25))
    true = envelope * np.sin(2 * np.pi * 10 * TF)
    made = synthetic(true[:, :, 0], true=true)
    made.scenario, made.rig = SCENARIO, SCENARIO.load_rig()
    assert 1.37 <= evaluate(made).settling_time[0] <= 1.75


def test_voltages_and_saturation(synthetic):
    """Truth: 7 V at most, a tenth of the samples under control limited."""
    made = run(synthetic, 0.1, 0.1)
    voltage = np.zeros((SAMPLES, 1))
    voltage[600] = -7.0
    saturated = np.zeros((SAMPLES, 1), dtype=bool)
    saturated[500:550] = True
    made.groups['voltage'] = {
        'voltage': voltage,
        'saturated': saturated,
        'present': np.ones((SAMPLES, 1), dtype=bool),
    }
    e = evaluate(made)
    assert e.largest_voltage[0] == 7.0
    assert e.saturated_share[0] == pytest.approx(0.1)
    assert any('up to 10 %' in n for n in notes_for(made, e))


def test_windows_are_found_from_the_phases(synthetic):
    """Truth: by hand, the last 60 % of STANDBY with the disturbance and the last 40 % of CONTROL."""
    phases = [
        (Phase.STANDBY, 0.0),
        (Phase.IDENTIFY, 1.0),
        (Phase.STANDBY, 2.0),
        (Phase.CONTROL, 5.0),
    ]
    found = find_windows(synthetic(np.zeros((1000, 1)), phases=phases), 3.0)
    assert found.uncontrolled == pytest.approx((3.8, 5.0))
    assert found.controlled == pytest.approx((8.0, 10.0))
    never = find_windows(synthetic(np.zeros((1000, 1)), phases=[(Phase.STANDBY, 0.0)]), 20.0)
    assert never.uncontrolled is None
    assert never.controlled is None


def test_a_run_cut_short_before_its_window_says_so(synthetic):
    """Truth: 4 s recorded, control expected from 7 s."""
    short = synthetic(np.zeros((400, 1)))
    short.scenario = SCENARIO
    with pytest.raises(SatvibError, match=r'ends at 4\.00 s, before the controlled window at 7'):
        evaluate(short)


def test_tones_and_onset_of_a_sum():
    """Truth: by hand."""
    parts = [
        {'kind': 'sine', 'frequency': 12.0, 'amplitude': 1.0, 'start': 3.0},
        {'kind': 'sine', 'frequency': 5.0, 'amplitude': 1.0, 'start': 2.0},
    ]
    both = make_disturbance({'kind': 'sum', 'terms': parts})
    assert disturbance_tones(both) == [5.0, 12.0]
    assert disturbance_onset(both) == 2.0
    assert disturbance_onset(make_disturbance(None)) == 0.0


def test_a_simulated_run_gets_its_open_loop_twin(quick_run):
    """Truth: in the window before control the run and the twin see the same disturbance; the plant's decay after ADAPT
    has died out, so the true levels agree within 1 %.
    """
    e, twin = analyse(quick_run)
    assert twin is not None
    same = evaluate(twin)
    np.testing.assert_allclose(
        e.levels['uncontrolled']['true_rms'], same.levels['uncontrolled']['true_rms'], rtol=0.01
    )
    assert np.all(np.isfinite(e.attenuation_open_loop['true_rms']))
