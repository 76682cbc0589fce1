"""A walk through malus in Python, cell by cell: a surface, its measurement in silico, a sky, a picture.

By the marks %% editors and Jupyter (jupytext) separate cells.
"""
# %% What does copper do to light? One call for a hundred wavelengths, a line of the specular plane for each.
import matplotlib
import numpy as np

import malus

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  pylint: disable=wrong-import-position,wrong-import-order

nm = np.linspace(400, 700, 100)
n, k = np.interp(nm, [400, 550, 700], [1.18, 1.02, 0.21]), np.interp(nm, [400, 550, 700], [2.21, 2.58, 4.20])
theta = np.linspace(0, 85, 86)
copper = malus.brdf("torrance-sparrow", 45, theta[:, None], 180, nm, n=n, k=k, sigma=0.15)
reflected = copper[..., :, 0]  # of unpolarised light
print("matrices:", copper.shape, "all of them can exist:", malus.is_realizable(copper, 1e-9).all())

# %% Degree of polarisation by angle, at both ends of the spectrum.
figure, axes = pyplot.subplots(figsize=(6, 4), constrained_layout=True)
for band in (0, 99):
    axes.plot(theta, malus.dolp(reflected[:, band]), label=f"{nm[band]:.0f} nm")
axes.set(xlabel="zenith angle of the viewer [deg]", ylabel="DoLP", title="Copper, light from 45 deg")
axes.legend(frameon=False)
figure.savefig("copper.png", dpi=150)

# %% What is such a matrix made of?
parts = malus.lu_chipman(copper[60, 50])
print(f"diattenuation {parts.diattenuation:.3f}, retardance {parts.retardance_deg:.1f} deg, depolarisation {parts.depolarization_power:.3f}")

# %% A camera behind a turning polariser sees a cosine of twice the angle.
angle = np.arange(0, 180, 45)
seen = malus.apply(malus.linear_polarizer(angle), reflected[60, 50])[..., 0]
print("readings:", seen.round(4))

# %% The sky over Rochester, an afternoon in June.
sun = malus.sun(43.16, -77.61, "2001-06-10T17:00:00-04:00")
sky = malus.sky(wavelength_nm=[450, 650], sun_zenith_deg=float(sun.zenith_deg), albedo=0.2, irradiance="astm-e490")
sky.malus.plot(band=0).savefig("sky.png", dpi=150)

# %% A picture: a sheet of water before a camera, under this sky.
scene = {
    "malus": 1,
    "bands": {"wavelength_nm": [450, 650]},
    "geometry": [{"ground": {"z_m": 0, "material": "water"}}],
    "materials": {"water": {"model": "torrance-sparrow", "n": 1.34, "k": 0, "sigma": 0.1, "diffuse": "none"}},
    "sun": {"zenith_deg": float(sun.zenith_deg), "azimuth_deg": float(sun.azimuth_deg)},
    "sky": {"model": "rayleigh", "albedo": 0.2},
    "sensor": {"kind": "framing", "width": 96, "height": 64, "field_of_view_deg": 60},
    "platform": {"position_m": [0, 0, 10], "look_at_m": [0, 12, 0], "up": [0, 0, 1]},
    "radiometry": {"sampling": "importance", "rays": [64, 1], "seed": 1},
}
picture = malus.render(scene)
picture.malus.plot().savefig("water.png", dpi=150)
print(picture)
