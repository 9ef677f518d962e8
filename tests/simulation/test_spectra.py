"""Spectra and envelopes of outputs: sines of known amplitude, and a vibration that fades."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from scipy import signal as scipy_signal

import kinform
from kinform.exports import export
from kinform.reports.page.curves import Plot, Series
from kinform.reports.page.plots import plot_groups
from kinform.reports.page.spectra import envelope_plots, spectrum_svg
from kinform.simulation import amplitude_spectrum, envelope


@pytest.mark.parametrize(("frequency", "amplitude"), [(7.0, 0.3), (7.023, 2.0), (12.34567, 5e-4), (41.05, 1e3)])
def test_a_sine_is_named_with_its_frequency_and_amplitude(frequency, amplitude):
    time = np.arange(0.0, 10.0, 0.01)
    spectrum = amplitude_spectrum(time, 4.0 - 0.7 * time + amplitude * np.sin(2 * np.pi * frequency * time + 0.4))
    first = spectrum.lines[0]
    assert first.frequency == pytest.approx(frequency, rel=1e-6)
    assert first.amplitude == pytest.approx(amplitude, rel=1e-4)
    assert len(spectrum.lines) == 1


def test_two_sines_of_one_run_are_told_apart_and_ordered():
    time = np.linspace(0.0, 8.0, 1601)
    values = 0.2 * np.cos(2 * np.pi * 11.3 * time) + 1.5 * np.sin(2 * np.pi * 3.1 * time)
    lines = amplitude_spectrum(time, values).lines
    assert [line.frequency for line in lines] == pytest.approx([3.1, 11.3], abs=2e-3)
    assert [line.amplitude for line in lines] == pytest.approx([1.5, 0.2], rel=2e-3)


def test_the_spectrum_is_that_of_scipy():
    time, values = np.arange(500) * 0.004, np.random.default_rng(3).normal(size=500).cumsum()
    spectrum = amplitude_spectrum(time, values)

    def level(samples):
        place, weights = np.arange(500), np.sqrt(scipy_signal.get_window("hann", 500))
        return samples - np.polyval(np.polyfit(place, samples.ravel(), 1, w=weights), place)

    frequency, power = scipy_signal.periodogram(values, 250.0, window="hann", detrend=level, scaling="spectrum")
    np.testing.assert_allclose(spectrum.frequency, frequency, rtol=1e-12)
    # The power of a sine of amplitude A is A²/2.
    np.testing.assert_allclose(spectrum.amplitude[1:-1], np.sqrt(2.0 * power[1:-1]), rtol=1e-9)


def test_a_shorter_last_step_is_left_out_and_too_little_has_none():
    time = np.append(np.arange(0.0, 2.0, 0.01), 2.0 - 0.004)
    values = np.sin(2 * np.pi * 5.0 * time)
    assert len(amplitude_spectrum(time, values).frequency) == len(amplitude_spectrum(time[:-1], values[:-1]).frequency)
    assert amplitude_spectrum(time[:15], values[:15]) is None
    values[3] = np.nan
    assert amplitude_spectrum(time, values) is None


def test_the_envelope_of_a_vibration_that_fades_is_its_exponential():
    time = np.arange(0.0, 6.0, 0.001)
    fading = np.exp(-0.3 * time)
    low, high = envelope(time, fading * np.sin(2 * np.pi * 10.0 * time), 0.1)
    inner = slice(100, -100)
    # Half a period of 0.1 s before, the curve is at most this much higher.
    assert np.all(high[inner] <= np.exp(0.3 * 0.0505) * fading[inner])
    assert np.all(high[inner] >= np.exp(-0.3 * 0.0505) * fading[inner])
    np.testing.assert_allclose(low[inner], -high[inner], rtol=0.02)
    assert envelope(time[:700], time[:700], 0.1) is None


def test_figures_say_their_lines_in_words():
    time = np.arange(0.0, 4.0, 0.005)
    plot = Plot("tip: <position>", "mm", (Series("x", np.sin(50.0 * time)), Series("z", 3.0 + 0.0 * time)))
    drawn = spectrum_svg(plot, time)
    assert "x: 1 mm at 7.9" in drawn and "tip: &lt;position&gt;" in drawn and "<position>" not in drawn
    assert 'role="img"' in drawn and "amplitude in mm from 0 to " in drawn and "up to 100 Hz less than" in drawn
    (around,) = envelope_plots(plot, time)
    assert [series.label for series in around.series] == ["curve", "least", "greatest"]
    still = Plot("still", "mm", (Series("", np.full(800, 0.1)),))
    assert spectrum_svg(still, time) == "" and envelope_plots(still, time) == []


MASS, STIFFNESS, DAMPING = 2.0, 1800.0, 1.2
SPRUNG = f"""
schema = 1
[assembly]
name = "sprung"
units = "mm"
ground = "frame"
[[part]]
name = "frame"
[[part]]
name = "block"
mass = {MASS}
centre_of_mass = [0, 0, 0]
inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
[function]
complete = true
[[function.joint]]
name = "slide"
between = ["frame", "block"]
type = "prismatic"
axis = [1, 0, 0]
[[function.drive]]
joint = "slide"
kind = "spring"
stiffness = {STIFFNESS}
[[function.drive]]
joint = "slide"
kind = "damper"
damping = {DAMPING}
[[function.drive]]
joint = "slide"
kind = "effort"
law = {{type = "sine", amplitude = 40, frequency = 2.5}}
[simulation]
level = "dynamic"
duration = 6
step = 0.005
[simulation.initial.slide]
position = 30
[[simulation.sensor]]
name = "block"
kind = "point"
part = "block"
"""


@pytest.fixture(scope="module")
def sprung(tmp_path_factory):
    """A block on a spring, pushed to and fro, from 30 mm aside."""
    path = tmp_path_factory.mktemp("sprung") / "sprung.toml"
    path.write_text(SPRUNG)
    return kinform.run(path)


def test_a_manifest_gives_the_lines_of_the_oscillator(sprung):
    run = sprung.simulation
    position = next(k for k, r in enumerate(run.readings) if (r.quantity, r.component) == ("position", "x"))
    spectrum = amplitude_spectrum(run.time, run.sensed[:, position])
    own = np.sqrt(STIFFNESS / MASS - (0.5 * DAMPING / MASS) ** 2) / (2.0 * np.pi)
    speed = 2.0 * np.pi * 2.5
    forced = 40.0 / np.hypot(STIFFNESS - MASS * speed**2, DAMPING * speed)
    lines = {round(line.frequency, 1): line for line in spectrum.lines}
    assert lines[2.5].frequency == pytest.approx(2.5, abs=5e-3)
    assert lines[2.5].amplitude == pytest.approx(forced, rel=0.02)
    assert lines[round(own, 1)].frequency == pytest.approx(own, abs=5e-3)


def test_the_table_of_spectra_and_the_page_have_them(sprung):
    files = export(sprung.design, "csv").files
    header, *rows = csv.reader(io.StringIO(files["spectra.csv"].decode()))
    table = np.array(rows, dtype=float)
    assert header[0] == "frequency" and "block.position.x" in header and "3 slide effort.effort" in header
    effort = table[:, header.index("3 slide effort.effort")]
    assert table[effort.argmax(), 0] == pytest.approx(2.5, abs=0.1) and effort.max() == pytest.approx(40.0, rel=0.01)
    groups = {heading: (drawn, left) for heading, drawn, left in plot_groups(sprung.design)}
    drawn, method = groups["Spectra of sensors and drives"]
    assert any("block: position" in svg and "at 2.5 Hz" in svg for svg in drawn) and "Hann" in method
    assert any("block: position, x" in svg for svg in groups["Envelopes of sensors and drives"][0])
