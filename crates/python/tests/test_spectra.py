"""Spectra, glasses, metals and colours against published numbers and against colour-science."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from etalon import SettingError, spectra


def test_glass_has_its_catalogue_numbers():
    # Schott's data sheet of N-BK7: n_d 1.51680, Abbe number 64.17, to the digits printed.
    assert spectra.glass("N-BK7", 587.5618).shape == ()
    assert abs(spectra.glass("N-BK7", 587.5618) - 1.5168) < 5e-6
    assert abs(spectra.abbe_number("N-BK7") - 64.17) < 5e-3
    n = spectra.glass("N-BK7", [[486.1327, 656.2725]])
    assert n.shape == (1, 2)
    assert abs((spectra.glass("N-BK7", 587.5618) - 1) / (n[0, 0] - n[0, 1]) - spectra.abbe_number("N-BK7")) < 1e-9


def test_outside_of_the_fit_is_an_error_or_clamped():
    with pytest.raises(SettingError, match="N-BK7"):
        spectra.glass("N-BK7", [100, 500])
    inside, outside = spectra.glass("N-BK7", [300, 100], clamp=True)
    assert outside >= inside
    with pytest.raises(SettingError, match="nm"):
        spectra.glass("N-BK7", [0, 500])
    assert spectra.glass("N-BK7", []).shape == (0,)


def test_names_that_are_unknown_list_those_that_are():
    for of, name in ((spectra.glass, "N-BK7"), (spectra.metal, "Ag"), (spectra.illuminant, "D65")):
        with pytest.raises(SettingError, match=name):
            of("unobtainium", 500)
        with pytest.raises(SettingError):
            of(None, 500)
    assert "N-BK7" in spectra.glasses() and "Au" in spectra.metals() and spectra.illuminants() == ["D65", "E", "A"]


def test_metals_reflect_as_measured():
    # Johnson & Christy 1972, at 1.51 eV: silver has n 0.04 and k 5.727, to the digits printed.
    silver = spectra.metal("Ag", 1239.841984 / 1.51)
    assert silver.dtype == np.complex128
    assert abs(silver.real - 0.04) < 5e-3 and abs(silver.imag - 5.727) < 5e-4
    nm = np.array([450.0, 650.0])
    n = spectra.metal("Au", nm)
    reflectance = np.abs((n - 1) / (n + 1)) ** 2
    assert reflectance[1] > 0.9 > 0.5 > reflectance[0], "gold is yellow"


def test_a_black_body_obeys_wien_and_stefan_boltzmann():
    temperature = 5778.0
    nm = np.arange(50.0, 100_000.0, 0.5)
    radiance = spectra.blackbody(temperature, nm)
    assert abs(nm[radiance.argmax()] - 2.897771955e6 / temperature) < 0.5
    # ∫L dλ = σT⁴/π; beyond 0.1 mm lie 5e-6 of it, and the trapezoid rule errs by less.
    total = ((radiance[1:] + radiance[:-1]) / 2).sum() * 0.5
    assert abs(total / (5.670374419e-8 * temperature**4 / np.pi) - 1) < 1e-5


def test_the_constant_spectrum_has_y_1_and_d65_is_white():
    nm = np.arange(360.0, 831.0)
    assert abs(spectra.xyz(np.ones_like(nm), nm)[1] - 1) < 1e-12
    rgb = spectra.xyz_to_rgb(spectra.xyz(spectra.illuminant("D65", nm), nm))
    # The published white point (0.3127, 0.3290) has four digits, the sum of the published table others: 1e-3 apart.
    assert np.allclose(rgb, 1, atol=1e-3)
    stack = spectra.xyz([np.ones_like(nm), 2 * np.ones_like(nm)], nm)
    assert stack.shape == (2, 3) and np.allclose(stack[1], 2 * stack[0])
    for wrong in (([1, 2], [500]), ([1, 2], [500, 500]), (1, 500)):
        with pytest.raises(SettingError):
            spectra.xyz(*wrong)


def test_colours_go_there_and_back():
    rng = np.random.default_rng(1)
    rgb = rng.uniform(0, 1, (5, 7, 3))
    # Rounding of matrices to 64 bits.
    assert np.allclose(spectra.xyz_to_rgb(spectra.rgb_to_xyz(rgb)), rgb, atol=1e-12)
    assert np.allclose(spectra.srgb_decode(spectra.srgb_encode(rgb)), rgb, atol=1e-12)
    nm = np.arange(360.0, 831.0)
    reflectance = spectra.reflectance_of_rgb([0.8, 0.3, 0.1], nm)
    assert 0 <= reflectance.min() and reflectance.max() <= 1
    found = spectra.xyz_to_rgb(spectra.xyz(reflectance * spectra.illuminant("D65", nm), nm))
    assert np.allclose(found, [0.8, 0.3, 0.1], atol=2e-3)
    emission = spectra.emission_of_rgb([2, 1, 0.5], nm, white="A")
    # The fit ends at 1e-9 of the largest channel.
    assert np.allclose(spectra.xyz_to_rgb(spectra.xyz(emission, nm)), [2, 1, 0.5], atol=1e-8)
    for wrong in ([1, 2], [[1, 2, 3]], "red", [np.nan, 0, 0], [2, 0, 0]):
        with pytest.raises(SettingError):
            spectra.reflectance_of_rgb(wrong, nm)


def test_the_observer_and_illuminants_are_those_of_colour_science():
    colour = pytest.importorskip("colour")
    nm = np.arange(360.0, 831.0)
    theirs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    # Both print the standard's table: seven significant digits.
    assert np.allclose(spectra.colour_matching(nm), theirs[nm], atol=1e-9)
    for name, ours in (("D65", "D65"), ("A", "A")):
        spd = colour.SDS_ILLUMINANTS[name].copy().align(colour.SpectralShape(380, 780, 5))
        found = spectra.illuminant(ours, spd.wavelengths)
        ratio = found / spd.values
        assert np.allclose(ratio, ratio.mean(), rtol=1e-4), name
    sample = colour.SDS_COLOURCHECKERS["ColorChecker N Ohta"]["blue sky"].copy().align(colour.SpectralShape(380, 780, 5))
    illuminant = colour.SDS_ILLUMINANTS["D65"]
    with warnings.catch_warnings():
        # It says that it brings both spectra to one range.
        warnings.simplefilter("ignore")
        theirs = colour.sd_to_XYZ(sample, illuminant=illuminant) / 100
    light = spectra.illuminant("D65", sample.wavelengths)
    ours = spectra.xyz(sample.values * light, sample.wavelengths) / spectra.xyz(light, sample.wavelengths)[1]
    # They sum from 380 to 780 nm at 5 nm with interpolation of their own.
    assert np.allclose(ours, theirs, rtol=2e-3)


def test_a_glass_reflects_as_its_index_says():
    """A plate seen head-on reflects the sky by Fresnel's ((n − 1) / (n + 1))², for each band."""
    import etalon

    scene = etalon.load({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0, 0, 5], "direction": [0, 0, -1], "height_m": 0.01},
        "film": {"width": 32, "height": 32},
        "integrator": {"max_depth": 3, "wavelength_range_nm": [390, 710]},
        "objects": [
            {
                "shape": {"type": "parallelogram", "origin_m": [-1, -1, 0], "u_m": [2, 0, 0], "v_m": [0, 2, 0]},
                "material": {"type": "dielectric", "interior": "N-SF11"},
            },
            {
                "shape": {"type": "parallelogram", "origin_m": [-9, -9, -1], "u_m": [18, 0, 0], "v_m": [0, 18, 0]},
                "material": {"type": "black"},
            },
        ],
        "lights": [{"type": "environment", "radiance": 1}],
    })
    picture = scene.render(spp=256, bands=(450, 650, 50))
    n = spectra.glass("N-SF11", picture.wavelengths_nm)
    found = picture.spectrum(0, 0, 32, 32)
    # The index varies within a band: by its mean slope between bands, half of that to each side, which evens out to second order.
    slack = np.abs(np.diff(((n - 1) / (n + 1)) ** 2)).max() / 4
    assert (np.abs(found.radiance - ((n - 1) / (n + 1)) ** 2) < 5 * found.error + slack).all()
