"""Reads spectral EXR files by an independent reader, and compares names, units and values with our own channels.

    pip install colour-science==0.4.7 OpenImageIO OpenEXR numpy
    python3 tests/spectral-exr.py [path of etalon]
"""

import os
import pathlib
import subprocess
import sys
import tempfile

import colour
import numpy as np
import OpenEXR

here = pathlib.Path(__file__).resolve().parent.parent
etalon = sys.argv[1] if len(sys.argv) > 1 else here / "target/release/etalon"

for scene, grey in [("prism.json", False), ("furnace.json", True)]:
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "x.exr")
        options = "--size 48x30 --spp 64 --bands 400:700:10 --quiet".split()
        subprocess.run([etalon, "render", here / "scenes" / scene, "-o", path, *options], check=True)
        components, specification = colour.read_spectral_image_Fichet2021(path, additional_data=True)
        assert list(components) == ["S0"], list(components)
        wavelengths, values = components["S0"]
        assert np.array_equal(np.asarray(wavelengths), np.arange(400, 701, 10)), wavelengths
        assert values.shape == (30, 48, 31), values.shape
        assert specification.is_emissive and not specification.is_polarised, specification
        attributes = {a.name: a.value for a in specification.attributes}
        assert attributes["emissiveUnits"] == "W.m^-2.sr^-1", attributes
        assert attributes["spectralLayoutVersion"] == "1.0", attributes
        with OpenEXR.File(path, separate_channels=True) as file:
            channels = file.channels()
            for index, wavelength in enumerate(range(400, 701, 10)):
                ours = channels[f"S0.{wavelength},000000nm"].pixels
                assert np.array_equal(ours, values[..., index].astype(np.float32)), wavelength
        if grey:
            # A furnace under D65 with Y = 0.5, from tables that are not ours.
            fine = np.arange(360, 830.5, 0.5)
            d65 = colour.SDS_ILLUMINANTS["D65"]
            d65 = np.interp(fine, d65.wavelengths, d65.values)
            observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
            luminous = np.interp(fine, observer.wavelengths, observer.values[:, 1])
            d65 *= 0.5 * luminous.sum() / (d65 * luminous).sum()
            for index, wavelength in enumerate(wavelengths):
                band = d65[np.abs(fine - wavelength) <= 5]
                truth = (band.sum() - (band[0] + band[-1]) / 2) / (len(band) - 1)
                assert np.allclose(values[..., index], truth, rtol=1e-4), (wavelength, truth, values[0, 0, index])
        print(f"{scene}: {len(wavelengths)} bands, mean radiance {values.mean():.6g}")

# Polarising film: the same bands of each Stokes parameter, and none more polarised than it is bright.
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "x.exr")
    options = "--size 48x27 --spp 64 --bands 400:700:20 --quiet".split()
    subprocess.run([etalon, "render", here / "scenes/polarisers.json", "-o", path, *options], check=True)
    components, specification = colour.read_spectral_image_Fichet2021(path, additional_data=True)
    assert sorted(components) == ["S0", "S1", "S2", "S3"], list(components)
    assert specification.is_emissive and specification.is_polarised, specification
    assert {a.name: a.value for a in specification.attributes}["polarisationHandedness"] == "right"
    s0, *others = (components[name][1] for name in ["S0", "S1", "S2", "S3"])
    assert all(values.shape == (27, 48, 16) for values in [s0, *others])
    with OpenEXR.File(path, separate_channels=True) as file:
        for parameter, values in enumerate([s0, *others]):
            for index, wavelength in enumerate(range(400, 701, 20)):
                ours = file.channels()[f"S{parameter}.{wavelength},000000nm"].pixels
                assert np.array_equal(ours, values[..., index].astype(np.float32)), (parameter, wavelength)
    polarised = np.sqrt(sum(values**2 for values in others))
    assert (polarised <= s0 * (1 + 1e-5)).all() and polarised.max() > 0.4, polarised.max()
    print(f"polarisers.json: S0 {s0.mean():.6g}, polarised {polarised.mean():.6g}")
