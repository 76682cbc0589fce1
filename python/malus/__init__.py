"""Polarimetric image simulation: surfaces, skies, spheres, scenes and Stokes algebra.

The numbers are those of the program ``malus``, to the last bit. Angles are degrees, wavelengths nanometres; the conventions of
Stokes vectors (what is horizontal, which hand is right) are those of the book's first chapter, and are in the attributes of every dataset.

>>> import malus
>>> malus.brdf("lambertian", 30, 40, 180, reflectance=0.2)[0, 0].round(4)
0.0637
"""
from ._malus import __version__
from .air import Spheres, SunPosition, mie, skies, sky, sun
from .plot import MalusAccessor
from .scene import open, render  # pylint: disable=redefined-builtin
from .stokes import (LuChipman, aolp, apply, coherency_eigenvalues, docp, dolp, dop, is_physical, is_realizable, linear_polarizer,
                     lu_chipman, product, retarder, rotate, rotate_mueller)
from .surface import Model, Parameter, brdf, dhr, emissivity, models

__all__ = [
    "LuChipman", "MalusAccessor", "Model", "Parameter", "Spheres", "SunPosition", "__version__", "aolp", "apply", "brdf",
    "coherency_eigenvalues", "dhr", "docp", "dolp", "dop", "emissivity", "is_physical", "is_realizable", "linear_polarizer",
    "lu_chipman", "mie", "models", "open", "product", "render", "retarder", "rotate", "rotate_mueller", "skies", "sky", "sun",
]
