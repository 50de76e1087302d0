"""Etalon: a physically based spectral path tracer whose pictures carry their own error.

>>> import etalon
>>> scene = etalon.load("scenes/cornell.json")
>>> picture = scene.render(error=0.05, size=(128, 128))
>>> picture.rgb.shape, picture.error.shape
((128, 128, 3), (128, 128, 3))
>>> picture.save("cornell.exr")

======================================  =======================================================
scenes from files, dicts and texts      :func:`load`, :class:`Scene`
pixels, errors, bands, files            :class:`Picture`, :func:`read`
what accuracy will cost                 :meth:`Scene.quote`
the picture while it is rendered        :meth:`Scene.passes`
whether two pictures differ             :func:`compare`
illuminants, glasses, metals, colours   :mod:`etalon.spectra`
scenes with known answers               :mod:`etalon.oracle`
======================================  =======================================================

The command line is ``python -m etalon``, or ``etalon``.
"""

from . import oracle, spectra
from ._errors import (
    EtalonError,
    NoLightError,
    PictureError,
    Problem,
    RenderInterrupted,
    SceneError,
    SettingError,
)
from ._etalon import VERSION as __version__
from ._picture import Picture, Spectrum, compare, read
from ._results import (
    ChannelTest,
    Comparison,
    Cost,
    Effect,
    Explanation,
    Quote,
    Replay,
)
from ._scene import Progress, Scene, Settings, load, schema

__all__ = [
    "ChannelTest",
    "Comparison",
    "Cost",
    "Effect",
    "EtalonError",
    "Explanation",
    "NoLightError",
    "Picture",
    "PictureError",
    "Problem",
    "Progress",
    "Quote",
    "RenderInterrupted",
    "Replay",
    "Scene",
    "SceneError",
    "SettingError",
    "Settings",
    "Spectrum",
    "__version__",
    "compare",
    "load",
    "oracle",
    "read",
    "schema",
    "spectra",
]
