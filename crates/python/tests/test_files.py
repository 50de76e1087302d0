"""Files and arrays of other packages: OpenEXR, imageio, xarray, colour-science."""

from __future__ import annotations

import numpy as np
import pytest

import etalon


@pytest.fixture
def picture(ball):
    ball["camera"]["vertical_fov_deg"] = 40
    return etalon.load(ball).render(spp=16, bands=(450, 650, 50), aov="depth,normal,uv,position,object")


def test_an_exr_file_comes_back_as_it_was(picture, tmp_path):
    path = tmp_path / "ball.exr"
    picture.save(path)
    again = etalon.read(path)
    assert sorted(again.names) == sorted(picture.names)
    assert all(again.channel(name).tobytes() == picture.channel(name).tobytes() for name in picture.names)
    assert again.attributes == picture.attributes and again.report == {}
    assert again.relative_error == pytest.approx(picture.report["error"]["relative_rmse"], rel=1e-6)
    assert etalon.compare(path, picture).verdict == "equal"


def test_openexr_reads_the_file(picture, tmp_path):
    OpenEXR = pytest.importorskip("OpenEXR")
    path = tmp_path / "ball.exr"
    picture.save(path)
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    assert np.array_equal(channels["G"], picture.rgb[..., 1])
    assert np.array_equal(channels["S0.550,000000nm"], picture.bands[..., 2])
    assert np.array_equal(channels["Error.S0.550,000000nm"], picture.bands_error[..., 2])


def test_openexr_writes_a_file_that_we_read(picture, tmp_path):
    OpenEXR = pytest.importorskip("OpenEXR")
    path = tmp_path / "other.exr"
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGB": picture.rgb}) as file:
        file.write(str(path))
    assert np.array_equal(etalon.read(path).rgb, picture.rgb)


def test_imageio_takes_and_gives_the_arrays(picture, tmp_path):
    imageio = pytest.importorskip("imageio.v3")
    imageio.imwrite(tmp_path / "theirs.png", picture.develop())
    picture.save(tmp_path / "ours.png")
    assert np.array_equal(imageio.imread(tmp_path / "theirs.png"), imageio.imread(tmp_path / "ours.png"))
    # The linear light of a PNG is known to half a level of 8 bits.
    read = etalon.read(tmp_path / "theirs.png")
    levels = etalon.spectra.srgb_encode(np.clip(picture.rgb, 0, 1)) - etalon.spectra.srgb_encode(read.rgb)
    assert np.abs(levels).max() < 0.5 / 255 + 1e-6
    pytest.importorskip("tifffile")
    imageio.imwrite(tmp_path / "linear.tiff", picture.rgb)
    assert np.array_equal(imageio.imread(tmp_path / "linear.tiff"), picture.rgb)


def test_xarray_has_every_array_with_its_coordinates(ball, picture, tmp_path):
    xarray = pytest.importorskip("xarray")
    data = picture.to_xarray()
    assert np.array_equal(data.rgb, picture.rgb) and np.array_equal(data.bands_error, picture.bands_error)
    assert data.bands.sel(wavelength=550).dims == ("y", "x") and data.bands.attrs["units"] == "W m-2 sr-1 nm-1"
    assert data.normal.dims == ("y", "x", "axis") and data.depth.attrs["units"] == "m"
    assert data.rgb.sel(channel="G").shape == (24, 32)
    part = etalon.load(ball).render(spp=1, crop=(3, 9, 5, 7)).to_xarray()
    assert part.x.values.tolist() == [3, 4, 5, 6, 7, 8] and part.y.values.tolist() == [5, 6]
    assert isinstance(data, xarray.Dataset) and "plan" in data.attrs
    pytest.importorskip("scipy")
    data.to_netcdf(tmp_path / "ball.nc", engine="scipy")
    with xarray.open_dataset(tmp_path / "ball.nc", engine="scipy") as again:
        assert np.array_equal(again.bands, picture.bands)
        back = etalon.Picture.from_arrays(again.rgb, again.rgb_error)
    assert etalon.compare(back, picture).verdict == "equal"


def test_colour_science_takes_a_spectrum(picture):
    colour = pytest.importorskip("colour")
    spectrum = picture.spectrum(10, 8, 4, 4)
    theirs = colour.SpectralDistribution(spectrum.radiance, spectrum.wavelengths_nm)
    assert theirs.shape.interval == 50
    rgb = colour.XYZ_to_RGB(etalon.spectra.rgb_to_xyz(picture.rgb), "ITU-R BT.709", apply_cctf_encoding=False)
    # Their matrix is rounded to four digits.
    assert np.allclose(rgb, picture.rgb, atol=2e-3 * picture.rgb.max())


def test_colour_science_reads_our_spectral_files(picture, tmp_path):
    colour = pytest.importorskip("colour")
    # This reader of colour-science needs the package openimageio.
    pytest.importorskip("OpenImageIO", reason="the package openimageio is not installed")
    path = tmp_path / "ball.exr"
    picture.save(path)
    components = colour.read_spectral_image_Fichet2021(str(path))
    wavelengths, bands = components["S0"][:2]
    assert np.allclose(np.asarray(wavelengths, float), picture.wavelengths_nm)
    assert np.array_equal(np.asarray(bands, np.float32), picture.bands)


def test_spectra_of_regions_have_the_error_of_a_mean(picture):
    spectrum = picture.spectrum(10, 8, 4, 4)
    part = picture.bands[8:12, 10:14].astype(float)
    errors = picture.bands_error[8:12, 10:14].astype(float)
    assert np.allclose(spectrum.radiance, part.mean(axis=(0, 1)), rtol=1e-12)
    assert np.allclose(spectrum.error, np.sqrt((errors**2).sum(axis=(0, 1))) / 16, rtol=1e-12)


def test_notebooks_see_the_picture_and_its_error(picture):
    import base64
    import io
    import re

    assert picture._repr_png_().startswith(b"\x89PNG")
    shown = picture._repr_html_()
    images = re.findall(r'src="data:image/png;base64,([^"]+)"', shown)
    assert len(images) == 2 and "relative standard error" in shown and "error " in shown
    imageio = pytest.importorskip("imageio.v3")
    first = imageio.imread(io.BytesIO(base64.b64decode(images[0])))
    assert np.array_equal(first, picture.develop())
    alone = etalon.Picture.from_arrays(picture.rgb)
    assert alone._repr_html_().count("<img") == 1


def test_arrays_of_others_become_pictures():
    rng = np.random.default_rng(1)
    rgb, error = rng.random((5, 7, 3)), rng.random((5, 7, 3))
    picture = etalon.Picture.from_arrays(rgb, error, channels={"Z": rng.random((5, 7))})
    assert picture.size == (7, 5) and np.array_equal(picture.rgb, rgb.astype(np.float32))
    assert np.array_equal(picture.error, error.astype(np.float32)) and picture.aovs["depth"].shape == (5, 7)
    # Also where memory lies otherwise.
    turned = etalon.Picture.from_arrays(np.asfortranarray(rgb).transpose(1, 0, 2))
    assert np.array_equal(turned.rgb, rgb.transpose(1, 0, 2).astype(np.float32))
    copy = picture.rgb
    copy[:] = 0
    assert picture.rgb.any(), "arrays are copies"
