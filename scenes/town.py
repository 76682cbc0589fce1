#!/usr/bin/python3
"""A town of a billion triangles, at noon and at night, in visible light and at 10 um.

    scenes/town.py                          writes scenes/generated/town/*.obj and *.csv (about 5 MB) and scenes/generated/town/town.json
    malus render scenes/generated/town/town.json --out out
    scenes/town-picture.py out/town.0000.img out/town.0001.img town.png
    scenes/town.py --triangles 1e7          a smaller one

The parking lot (parking-lot.py) grown: blocks of houses, parks and lots between streets, with the lot's own cars, trees and glass building.
Each kind of mesh is kept once; tables give the places of its copies, and the renderer shares its triangles ("shared": true). The number of
blocks follows from --triangles. It is invented, not surveyed. The same seed gives the same files. Six days of weather heat it before noon,
and all things of one kind share their temperatures, facet by facet.

Needs Python 3 and nothing else. Metres, x east, y north, z up; the town is centred on the origin.
"""
import argparse
import importlib.machinery
import importlib.util
import json
import math
import os
import pathlib
import random
from typing import Any

HERE = pathlib.Path(__file__).resolve().parent
_loader = importlib.machinery.SourceFileLoader('parking_lot', str(HERE / 'parking-lot.py'))
_spec = importlib.util.spec_from_loader('parking_lot', _loader)
assert _spec
lot = importlib.util.module_from_spec(_spec)
_loader.exec_module(lot)

BLOCK, STREET = 100.0, 16.0        # m: the side of a block, and the width of a street between two
PATCH = 10.0                       # m: the side of a patch of lawn
KINDS = ('park', 'houses', 'houses', 'lot')
LACQUERS = ('black-lacquer', 'white-lacquer', 'silver', 'red-paint')
NOON_TO_NIGHT_S = 12 * 3600
BANDS = [450, 550, 650, 10000]     # nm


# ---------------------------------------------------------------- meshes
def patch(rng: random.Random) -> Any:
    """Blades of grass on PATCH x PATCH metres, with their roots at z = 0."""
    mesh = lot.Mesh('a patch of lawn, blade by blade')
    mesh.facet('lawn', 'grass')
    for _ in range(14000):
        x, y, a = rng.uniform(0, PATCH), rng.uniform(0, PATCH), rng.uniform(0, lot.TAU)
        width, length, lean = 0.004 * rng.uniform(2, 4), rng.uniform(0.05, 0.14), rng.gauss(0, 0.4)
        dx, dy = width * math.cos(a), width * math.sin(a)
        mesh.face(mesh.vertex(x - dx, y - dy, 0), mesh.vertex(x + dx, y + dy, 0),
                  mesh.vertex(x - math.sin(a) * length * lean, y + math.cos(a) * length * lean, length))
    return mesh


def house(_: random.Random) -> Any:
    """9 x 11 m, two floors with windows, and a gable roof; the door to the south, on z = 0."""
    mesh = lot.Mesh('a house: walls, windows, roof')
    mesh.facet('walls', 'plaster')
    w, d, h, ridge = 4.5, 5.5, 5.6, 8.6
    mesh.box((-w, -d, 0), (w, d, h))
    mesh.facet('gables', 'plaster')
    for y, order in ((-d, 1), (d, -1)):
        corners = [mesh.vertex(-w, y, h), mesh.vertex(w, y, h), mesh.vertex(0, y, ridge)]
        mesh.face(*corners[::order])
    mesh.facet('roof', 'tiles')
    for side in (-1, 1):
        a = [(side * (w + 0.5), -d - 0.4, h - 0.3), (side * (w + 0.5), d + 0.4, h - 0.3),
             (0, d + 0.4, ridge + 0.05), (0, -d - 0.4, ridge + 0.05)]
        mesh.quad(*(a if side > 0 else a[::-1]))
    mesh.facet('windows', 'glass')
    for z in (0.9, 3.6):
        for x in (-3.2, -0.9, 1.6):
            mesh.quad((x, -d - 0.02, z), (x + 1.4, -d - 0.02, z), (x + 1.4, -d - 0.02, z + 1.3), (x, -d - 0.02, z + 1.3))
            mesh.quad((x + 1.4, d + 0.02, z), (x, d + 0.02, z), (x, d + 0.02, z + 1.3), (x + 1.4, d + 0.02, z + 1.3))
    return mesh


def tower(rng: random.Random) -> Any:
    """The glass building of the parking lot, its foot on z = 0 and its middle on the z axis."""
    mesh = lot.building(rng)
    moved = []
    for line in mesh.lines:
        if line.startswith('v '):
            x, y, z = map(float, line.split()[1:])
            line = f'v {x:.4f} {y - 44:.4f} {z + 0.3:.4f}'
        moved.append(line)
    mesh.lines = moved
    return mesh


def square(material: str, side: float) -> Any:
    mesh = lot.Mesh(f'a square of {material}')
    mesh.facet(material, material)
    s = side / 2
    mesh.quad((-s, -s, 0), (s, -s, 0), (s, s, 0), (-s, s, 0))
    return mesh


MESHES = {'patch': patch, 'house': house, 'tower': tower, 'tree': lot.tree, 'car': lot.car,
          'asphalt': lambda _: square('asphalt', BLOCK), 'lawn-ground': lambda _: square('turf', BLOCK)}


# ---------------------------------------------------------------- the town
class Town:
    """Rows of placements for each kind of thing."""

    def __init__(self) -> None:
        self.rows: dict[str, list[tuple[float, float, float, float, float]]] = {}

    def put(self, kind: str, x: float, y: float, z: float, turn: float, scale: float = 1.0) -> None:
        self.rows.setdefault(kind, []).append((x, y, z, turn, scale))

    def tree(self, rng: random.Random, x: float, y: float, z: float) -> None:
        self.put('tree', x + rng.gauss(0, 0.5), y + rng.gauss(0, 0.5), z, rng.uniform(0, 360), rng.uniform(0.8, 1.3))

    def car(self, rng: random.Random, x: float, y: float, z: float, turn: float) -> None:
        self.put('car-' + rng.choice(LACQUERS), x + rng.gauss(0, 0.1), y + rng.gauss(0, 0.15), z, turn + rng.gauss(0, 1.2))

    def block(self, rng: random.Random, kind: str, x: float, y: float) -> None:
        """A block with its middle at x, y, and the cars and trees of its streets."""
        half = BLOCK / 2
        for i in range(-4, 5):
            for side in (-1, 1):
                self.tree(rng, x + 11 * i, y + side * (half + 1.5), 0)
                if rng.random() < 0.4:
                    self.car(rng, x + 11 * i + 5.5, y + side * (half + 5), 0, 90 * side)
        if kind == 'lot':
            self.put('asphalt', x, y, 0.02, 0)
            for row in lot.ROWS:
                for stall in range(-18, 18):
                    if rng.random() < 0.5:
                        self.car(rng, x + (stall + 0.5) * lot.STALL, y + 1.6 * row, 0.02, rng.choice((0, 180)))
            return
        self.put('lawn-ground', x, y, 0.01, 0)
        for i in range(10):
            for j in range(10):
                if kind == 'park' or j % 5 in (0, 4):
                    self.put('patch', x - half + PATCH * i, y - half + PATCH * j, 0.01, 0)
        if kind == 'park':
            for _ in range(160):
                self.tree(rng, x + rng.uniform(-half + 3, half - 3), y + rng.uniform(-half + 3, half - 3), 0)
            return
        if rng.random() < 0.2:
            self.put('tower', x, y, 0, rng.choice((0, 90, 180, 270)))
            return
        for i in range(5):
            for side in (-1, 1):
                self.put('house', x + 20 * (i - 2), y + 22 * side + rng.gauss(0, 1), 0, 180 if side > 0 else 0)
                self.tree(rng, x + 20 * (i - 2) + 10, y + 24 * side, 0)


def grow(triangles: float, counts: dict[str, int], seed: int) -> Town:
    """Blocks along a square spiral from the middle, until there are enough triangles."""
    town, rng = Town(), random.Random(f'{seed} town')
    x = y = 0
    dx, dy, run, left, turns, total = 1, 0, 1, 1, 0, 0
    while total < triangles:
        town.block(rng, KINDS[0] if (x, y) == (0, 0) else rng.choice(KINDS), x * (BLOCK + STREET), y * (BLOCK + STREET))
        total = sum(len(rows) * counts[mesh_of(kind)] for kind, rows in town.rows.items())
        x, y, left = x + dx, y + dy, left - 1
        if left == 0:
            dx, dy, turns = -dy, dx, turns + 1
            run += turns % 2 == 0
            left = run
    return town


def mesh_of(kind: str) -> str:
    return 'car' if kind.startswith('car-') else kind


# ---------------------------------------------------------------- the scene
# Thermal properties of a material: conductivity W/(m K), density kg/m^3, specific heat J/(kg K), thickness m (None: a half space),
# temperature K of
# the back (None: no heat passes it). Matter from ISO 10456:2007, table 3, but for leaves, which are four fifths water and as thick as leaves
# (they evaporate nothing here, and so are warmer than real ones), and for windows: the glass of two panes with the thermal resistance of the
# air between them, 0.17 m^2 K/W.
ROOM_K = 294.0
HEAT: dict[str, tuple[float, float, float, float | None, float | None]] = {
    'asphalt': (0.7, 2100, 1000, None, None), 'concrete': (2.0, 2400, 1000, 0.3, ROOM_K), 'soil': (1.5, 1500, 2000, None, None),
    'plaster': (0.8, 1600, 1000, 0.25, ROOM_K),         # a wall of lime and sand
    'tiles': (1.0, 2000, 800, 0.02, None),              # of clay, over an insulated attic
    'glass': (0.14, 830, 750, 0.024, ROOM_K), 'tyre': (0.13, 910, 1100, 0.02, None), 'bark': (0.13, 500, 1600, 0.1, None),
    'body': (50, 7800, 450, 0.0008, None),              # sheet steel under lacquer
    'chrome': (50, 7800, 450, 0.002, None), 'leaf': (0.4, 800, 3600, 0.0003, None)}
# Shares of sunlight that are absorbed where three visible bands do not suffice: a leaf reflects and transmits half of it in the near infrared
# (D. M. Gates, Biophysical Ecology, 1980), a lawn reflects 0.23 (FAO Irrigation and Drainage Paper 56, 1998); metal is guessed.
SUNLIGHT = {'leaf': 0.5, 'lawn': 0.77, 'metal': 0.4}


def thermal(matter: str, sunlight: str = '') -> dict[str, Any]:
    conductivity, density, specific_heat, thickness, back = HEAT[matter]
    made = {'conductivity_W_m_K': conductivity, 'density_kg_m3': density, 'specific_heat_J_kg_K': specific_heat}
    for key, value in (('thickness_m', thickness), ('back_temperature_K', back), ('solar_absorptance', SUNLIGHT.get(sunlight))):
        if value is not None:
            made[key] = value
    return made


def materials() -> dict[str, Any]:
    """Reflectances and constants in the bands, invented and of the usual size, and what heats and cools them."""

    def spectrum(values: list[float]) -> dict[str, Any]:
        return {'wavelength_nm': BANDS, 'values': values}

    def matt(values: list[float], heat: dict[str, Any]) -> dict[str, Any]:
        return {'model': 'lambertian', 'reflectance': spectrum(values), 'thermal': heat}

    def smooth(n: list[float], k: list[float], sigma: float, heat: dict[str, Any]) -> dict[str, Any]:
        return {'model': 'torrance-sparrow', 'n': spectrum(n), 'k': spectrum(k), 'sigma': sigma, 'diffuse': 'none', 'thermal': heat}

    def lacquer(below: list[float]) -> dict[str, Any]:
        return {'model': 'glossy-coating', 'n': 1.5, 'reflectance': spectrum(below), 'sigma': 0.03, 'thermal': thermal('body')}
    aluminium = ([0.6, 0.96, 1.5, 25], [5.4, 6.7, 7.8, 90])
    return {
        'asphalt': matt([0.08, 0.09, 0.1, 0.04], thermal('asphalt')), 'plaster': matt([0.5, 0.6, 0.65, 0.06], thermal('plaster')),
        'tiles': matt([0.08, 0.12, 0.35, 0.06], thermal('tiles')), 'concrete': matt([0.25, 0.3, 0.33, 0.06], thermal('concrete')),
        'grass': matt([0.04, 0.1, 0.05, 0.02], thermal('leaf', 'lawn')), 'turf': matt([0.05, 0.11, 0.06, 0.03], thermal('soil', 'lawn')),
        'foliage': matt([0.04, 0.11, 0.05, 0.03], thermal('leaf', 'leaf')), 'bark': matt([0.08, 0.1, 0.12, 0.05], thermal('bark')),
        'tyre': matt([0.04, 0.04, 0.04, 0.05], thermal('tyre')),
        'red-paint': lacquer([0.04, 0.05, 0.5, 0.05]), 'black-lacquer': lacquer([0.02, 0.02, 0.02, 0.05]),
        'white-lacquer': lacquer([0.75, 0.8, 0.8, 0.05]),
        'silver': smooth(*aluminium, 0.15, thermal('body', 'metal')), 'chrome': smooth(*aluminium, 0.05, thermal('chrome', 'metal')),
        'glass': smooth([1.53, 1.52, 1.51, 2.1], [0, 0, 0, 0.6], 0.02, thermal('glass'))}


def scene(town: Town, title: str, out: pathlib.Path) -> dict[str, Any]:
    geometry: list[dict[str, Any]] = [{'ground': {'z_m': 0, 'material': 'asphalt', 'facet': 'streets'}}]
    for kind in sorted(town.rows):
        entry: dict[str, Any] = {'obj': mesh_of(kind) + '.obj', 'facet_prefix': kind + '.', 'shared': True,
                                 'instances': {'file': kind + '.csv'}}
        if mesh_of(kind) == 'car':
            entry['materials'] = {'body': kind[len('car-'):]}
        geometry.append(entry)
    sun = {'latitude_deg': 43.16, 'longitude_deg': -77.61, 'time': '2001-06-10T13:00:00-04:00',
           'irradiance_W_m2_nm': {'wavelength_nm': BANDS, 'values': [1.996, 1.873, 1.589, 2.5e-4]}}
    # the blue sky, and the glow of water vapour and carbon dioxide in the window around 10 um
    sky = {'model': 'day-and-night', 'glow_optical_depth': {'wavelength_nm': BANDS, 'values': [0, 0, 0, 0.4]},
           'glow_atmosphere': 'us-standard', 'path_radiance': True}
    pose = {'position_m': [28, -260, 22], 'look_at_m': [-10, -150, 5]}     # over gardens, towards a parking lot and a park
    return {
        'malus': 1, 'title': title, 'bands': {'wavelength_nm': BANDS}, 'geometry': geometry, 'materials': materials(),
        'sun': sun, 'sky': sky, 'heat': {'weather': os.path.relpath(HERE / 'data' / 'clear-june.csv', out), 'days_before': 6},
        'sensor': {'kind': 'framing', 'width': 480, 'height': 320, 'field_of_view_deg': 54, 'samples_per_pixel': 4, 'jitter': True},
        'platform': {'poses': [{**pose, 'time_s': 0}, {**pose, 'time_s': NOON_TO_NIGHT_S}]},
        'radiometry': {'sampling': 'importance', 'rays': [8, 2, 1], 'seed': 1}}


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or '').split('\n', maxsplit=1)[0])
    options.add_argument('--out', type=pathlib.Path, default=HERE / 'generated' / 'town', help='directory of meshes, tables and scene')
    options.add_argument('--triangles', type=float, default=1e9, help='how many at least')
    options.add_argument('--seed', type=int, default=1)
    options.add_argument('--flat', action='store_true', help='copies do not share their triangles')
    given = options.parse_args()
    if not given.triangles >= 1:
        options.error('--triangles: give a number of at least 1')
    given.out.mkdir(parents=True, exist_ok=True)
    counts = {}
    for name, make in MESHES.items():
        mesh = make(random.Random(f'{given.seed} {name}'))
        mesh.save(given.out / (name + '.obj'))
        counts[name] = mesh.triangles
    town = grow(given.triangles, counts, given.seed)
    for kind, rows in town.rows.items():
        lines = ['x_m,y_m,z_m,rotate_z_deg,scale']
        lines += [f'{x:.2f},{y:.2f},{z:.2f},{turn:.1f},{scale:.2f}' for x, y, z, turn, scale in rows]
        (given.out / (kind + '.csv')).write_text('\n'.join(lines) + '\n')
    made = scene(town, 'A town at noon and at night', given.out)
    if given.flat:
        for entry in made['geometry']:
            entry.pop('shared', None)
    (given.out / 'town.json').write_text('// made by town.py\n' + json.dumps(made, indent=1) + '\n')
    total = sum(len(rows) * counts[mesh_of(kind)] for kind, rows in town.rows.items())
    copies = sum(len(rows) for rows in town.rows.values())
    print(f'{given.out / "town.json"}: {total} triangles in {copies} places')


if __name__ == '__main__':
    main()
