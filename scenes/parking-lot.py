#!/usr/bin/python3
"""A parking lot on a June noon: the larger outdoor scene of malus, about a million triangles.

    scenes/parking-lot.py            writes scenes/generated/parking-lot/*.obj (about 25 MB) and scenes/parking-lot.json
    malus render scenes/parking-lot.json

Chapter 2 of the thesis plans a simple outdoor scene, "for example a parking lot", as its second step of validation. This is one,
with the surfaces that a polarimeter distinguishes: asphalt and paint on it, cars (metal, lacquer, glass, rubber), a building with a
glass front, a pond with waves, grass blade by blade, and trees leaf by leaf. It is invented, not surveyed.

Needs Python 3 and nothing else. The same seed gives the same files: all chance comes from random.Random(seed), one generator a mesh,
and coordinates are written to a tenth of a millimetre.

Metres, x east, y north, z up. Seen from above:

        y
     50 |      building  (x -30..30, y 38..50, 15 m high, glass front to the south)
     30 |  ------------------------------
        | |  parking lot (x -40..40,      |   trees along both sides
    -30 |  ---- y -30..30) -------------
        |   lawn (x -38..4)    pond (x 10..38)     both y -54..-36
"""
import argparse
import json
import math
import pathlib
import random
from collections.abc import Callable
from typing import Any

TAU = 2 * math.pi
Point = tuple[float, float, float]


class Mesh:
    """Vertices and faces of one OBJ file, in the order in which they will be written."""

    def __init__(self, about: str) -> None:
        self.lines = [f'# {about}', '# made by parking-lot.py; metres, x east, y north, z up']
        self.vertices = 0
        self.triangles = 0

    def facet(self, name: str, material: str) -> None:
        self.lines += [f'o {name}', f'usemtl {material}']

    def vertex(self, x: float, y: float, z: float) -> int:
        """Returns the number by which faces name this vertex."""
        self.lines.append(f'v {x:.4f} {y:.4f} {z:.4f}')
        self.vertices += 1
        return self.vertices

    def face(self, *corners: int) -> None:
        """Counter-clockwise seen from outside; corners that fall together are named once."""
        kept = [c for i, c in enumerate(corners) if c != corners[i - 1]]
        if len(kept) >= 3:
            self.lines.append('f ' + ' '.join(map(str, kept)))
            self.triangles += len(kept) - 2

    def quad(self, a: Point, b: Point, c: Point, d: Point) -> None:
        self.face(*(self.vertex(*p) for p in (a, b, c, d)))

    def box(self, low: Point, high: Point, bottom: bool = False) -> None:
        (x0, y0, z0), (x1, y1, z1) = low, high
        v = [self.vertex(x, y, z) for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]
        for side in ((4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)):
            self.face(*(v[i] for i in side))
        if bottom:
            self.face(v[0], v[2], v[3], v[1])

    def rows(self, rows: list[list[int]], closed: bool = False, material: Callable[[int, int], str] | None = None) -> None:
        """Faces between rows of vertex numbers; material(row, column), where given, switches usemtl as needed."""
        pending: dict[str | None, list[tuple[int, ...]]] = {}
        for j in range(len(rows) - 1):
            width = len(rows[j])
            for i in range(width if closed else width - 1):
                k = (i + 1) % width
                name = material(j, i) if material else None
                pending.setdefault(name, []).append((rows[j][i], rows[j][k], rows[j + 1][k], rows[j + 1][i]))
        for name, faces in pending.items():
            if name:
                self.lines.append(f'usemtl {name}')
            for face in faces:
                self.face(*face)

    def save(self, path: pathlib.Path) -> None:
        path.write_text('\n'.join(self.lines) + '\n')
        print(f'{path}: {self.triangles} triangles')


# ---------------------------------------------------------------- the lot
STALL, DEPTH = 2.5, 5.0                     # a place for one car
ROWS = (-24.0, -7.0, 7.0, 24.0)             # y of the middle of each row of stalls
HALF = (40.0, 30.0)                         # half the lot, x and y


def lot_height(x: float, y: float) -> float:
    """Drains to the edges, with shallow hollows where the asphalt has sunk."""
    hollows = ((-18, 0.5, 4), (9, -15, 3), (26, 15, 3.5), (-30, -16, 2.5))
    fall = -0.02 * (y / HALF[1]) ** 2
    return fall - sum(0.03 * math.exp(-((x - a) ** 2 + (y - b) ** 2) / r ** 2) for a, b, r in hollows)


def is_line(x: float, y: float) -> bool:
    """The painted lines: 12 cm wide between stalls, from end to end of a stall."""
    nearest = round(x / STALL) * STALL
    return abs(x - nearest) < 0.06 and abs(x) < 37.6 and any(abs(y - row) < DEPTH / 2 for row in ROWS)


def lot(rng: random.Random) -> Mesh:
    mesh = Mesh('asphalt with painted lines, a kerb, and four puddles')
    mesh.facet('asphalt', 'asphalt')
    # the columns of the grid bracket each painted line
    xs = sorted({round(x, 4) for i in range(-16, 17) for d in (-1.25, -0.9, -0.6, -0.3, -0.06, 0.06, 0.3, 0.6, 0.9)
                 for x in (i * STALL + d,) if abs(x) <= HALF[0]} | {-HALF[0], HALF[0]})
    ys = [-HALF[1] + 0.2 * j for j in range(301)]
    rows = [[mesh.vertex(x, y, lot_height(x, y) + rng.uniform(-0.0015, 0.0015)) for x in xs] for y in ys]
    mesh.rows(rows, material=lambda j, i: 'paint' if is_line((xs[i] + xs[i + 1]) / 2, ys[j] + 0.1) else 'asphalt')
    mesh.facet('kerb', 'concrete')
    for low, high in (((-HALF[0] - 0.3, -HALF[1] - 0.3, -0.3), (HALF[0] + 0.3, -HALF[1], 0.12)),
                      ((-HALF[0] - 0.3, HALF[1], -0.3), (HALF[0] + 0.3, HALF[1] + 0.3, 0.12)),
                      ((-HALF[0] - 0.3, -HALF[1], -0.3), (-HALF[0], HALF[1], 0.12)),
                      ((HALF[0], -HALF[1], -0.3), (HALF[0] + 0.3, HALF[1], 0.12))):
        mesh.box(low, high)
    mesh.facet('puddles', 'still-water')
    for x, y, r in ((-18, 0.5, 4), (9, -15, 3), (26, 15, 3.5), (-30, -16, 2.5)):
        z = lot_height(x, y) + 0.012        # the asphalt itself is the shore
        rim = [mesh.vertex(x + r * math.cos(TAU * i / 64), y + r * math.sin(TAU * i / 64), z) for i in range(64)]
        middle = mesh.vertex(x, y, z)
        for i in range(64):
            mesh.face(middle, rim[i], rim[(i + 1) % 64])
    return mesh


# ---------------------------------------------------------------- a car
def power(value: float, exponent: float) -> float:
    return math.copysign(abs(value) ** exponent, value)


def superellipsoid(mesh: Mesh, centre: Point, half: Point, e_up: float, e_round: float, columns: int, rows: int, floor: float,
                   material: Callable[[float, float], str]) -> None:
    """|z|^(2/e_up) with |x|,|y|^(2/e_round); cut off below `floor`, which makes it open there."""
    rings = []
    for j in range(rows + 1):
        v = math.asin(max(-1.0, (floor - centre[2]) / half[2]))
        v += (math.pi / 2 - v) * j / rows
        ring = []
        for i in range(columns):
            u = TAU * (i + 0.5) / columns
            ring.append((centre[0] + half[0] * power(math.cos(v), e_up) * power(math.cos(u), e_round),
                         centre[1] + half[1] * power(math.cos(v), e_up) * power(math.sin(u), e_round),
                         centre[2] + half[2] * power(math.sin(v), e_up)))
        rings.append(ring)
    top = mesh.vertex(centre[0], centre[1], centre[2] + half[2])
    numbers = [[mesh.vertex(*p) for p in ring] for ring in rings[:-1]] + [[top] * columns]
    heights = [ring[0][2] for ring in rings]
    mesh.rows(numbers, closed=True, material=lambda j, i: material(i / columns, (heights[j] + heights[j + 1]) / 2))


def car(_: random.Random) -> Mesh:
    """4.4 m long along y, nose to the north, wheels on z = 0."""
    mesh = Mesh('a car: body, windows, bumpers, wheels')
    mesh.facet('body', 'body')
    superellipsoid(mesh, (0, 0, 0.62), (0.9, 2.2, 0.36), 0.45, 0.5, 112, 44, 0.3, lambda u, z: 'body')
    mesh.facet('cabin', 'body')

    def pane(u: float, z: float) -> str:
        pillar = min(abs(u * 4 - n) for n in (0.38, 1.62, 2.38, 3.62, 0.0, 2.0, 4.0)) < 0.05
        return 'glass' if 0.96 < z < 1.34 and not pillar else 'body'
    superellipsoid(mesh, (0, -0.25, 0.9), (0.8, 1.35, 0.55), 0.7, 0.6, 96, 40, 0.85, pane)
    mesh.facet('bumpers', 'chrome')
    for y in (-2.22, 2.10):
        mesh.box((-0.75, y, 0.4), (0.75, y + 0.12, 0.52), bottom=True)
    for name, x, y in (('front-left', -0.8, 1.35), ('front-right', 0.8, 1.35),
                       ('rear-left', -0.8, -1.35), ('rear-right', 0.8, -1.35)):
        mesh.facet('wheel-' + name, 'tyre')
        rings = [[mesh.vertex(x + dx, y + r * math.cos(TAU * i / 48), 0.32 + r * math.sin(TAU * i / 48)) for i in range(48)]
                 for dx, r in ((-0.11, 0.2), (-0.11, 0.32), (0.11, 0.32), (0.11, 0.2))]
        mesh.rows(rings[::-1], closed=True)
        mesh.facet('hub-' + name, 'chrome')
        for dx, order in ((0.1, 1), (-0.1, -1)):
            disk = [mesh.vertex(x + dx, y + 0.2 * math.cos(TAU * i / 48), 0.32 + 0.2 * math.sin(TAU * i / 48)) for i in range(48)]
            mesh.face(*disk[::order])
    return mesh


# ---------------------------------------------------------------- building, pond, lawn, trees
def building(rng: random.Random) -> Mesh:
    mesh = Mesh('a building with a glass front: panes, frames between them, concrete walls')
    x0, x1, y0, y1, top = -30.0, 30.0, 38.0, 50.0, 15.0
    mesh.facet('walls', 'concrete')
    mesh.quad((x1, y0, -0.3), (x1, y1, -0.3), (x1, y1, top), (x1, y0, top))
    mesh.quad((x1, y1, -0.3), (x0, y1, -0.3), (x0, y1, top), (x1, y1, top))
    mesh.quad((x0, y1, -0.3), (x0, y0, -0.3), (x0, y0, top), (x0, y1, top))
    mesh.quad((x0, y0, top), (x1, y0, top), (x1, y1, top), (x0, y1, top))
    mesh.quad((x0, y0, -0.3), (x1, y0, -0.3), (x1, y0, 0.4), (x0, y0, 0.4))
    mesh.facet('front', 'glass')
    wide, high = 2.0, 14.6 / 5
    for j in range(5):
        for i in range(30):
            # no two panes hang quite alike: a milliradian or two, as reflections in real fronts show
            tilt, turn = rng.gauss(0, 0.002) * high / 2, rng.gauss(0, 0.002) * wide / 2
            xa, xb, za, zb = x0 + wide * i, x0 + wide * (i + 1), 0.4 + high * j, 0.4 + high * (j + 1)
            mesh.quad((xa, y0 - turn - tilt, za), (xb, y0 + turn - tilt, za), (xb, y0 + turn + tilt, zb), (xa, y0 - turn + tilt, zb))
    mesh.facet('frames', 'chrome')
    for i in range(31):
        mesh.box((x0 + wide * i - 0.04, y0 - 0.08, 0.4), (x0 + wide * i + 0.04, y0, top))
    for j in range(6):
        mesh.box((x0, y0 - 0.07, 0.4 + high * j - 0.04), (x1, y0, 0.4 + high * j + 0.04))
    return mesh


def pond(rng: random.Random) -> Mesh:
    mesh = Mesh('a pond with small waves, and its rim')
    waves = [(rng.uniform(0.4, 2.5), rng.gauss(0.8, 0.5), rng.uniform(0, TAU)) for _ in range(24)]

    def height(x: float, y: float) -> float:
        # each wave: its length, the direction it runs, and where it begins; steepness 0.02 each
        return -0.2 + sum(0.02 / (TAU / length) / 4 * math.sin(TAU / length * (x * math.cos(a) + y * math.sin(a)) + p)
                          for length, a, p in waves)
    mesh.facet('pond', 'water')
    rows = [[mesh.vertex(10 + 0.1 * i, -54 + 0.1 * j, height(10 + 0.1 * i, -54 + 0.1 * j)) for i in range(281)] for j in range(181)]
    mesh.rows(rows)
    mesh.facet('rim', 'concrete')
    for low, high in (((9.6, -54.4, -0.3), (38.4, -54, 0.05)), ((9.6, -36, -0.3), (38.4, -35.6, 0.05)),
                      ((9.6, -54, -0.3), (10, -36, 0.05)), ((38, -54, -0.3), (38.4, -36, 0.05))):
        mesh.box(low, high)
    return mesh


def lawn(rng: random.Random) -> Mesh:
    mesh = Mesh('a lawn, blade by blade')
    mesh.facet('lawn', 'grass')
    for _ in range(110000):
        x, y, a = rng.uniform(-38, 4), rng.uniform(-54, -36), rng.uniform(0, TAU)
        width, length, lean = 0.004 * rng.uniform(2, 4), rng.uniform(0.05, 0.14), rng.gauss(0, 0.4)
        dx, dy = width * math.cos(a), width * math.sin(a)
        mesh.face(mesh.vertex(x - dx, y - dy, -0.3), mesh.vertex(x + dx, y + dy, -0.3),
                  mesh.vertex(x - math.sin(a) * length * lean, y + math.cos(a) * length * lean, -0.3 + length))
    return mesh


def tree(rng: random.Random) -> Mesh:
    """7 m high, on z = 0."""
    mesh = Mesh('a tree: trunk and leaves')
    mesh.facet('trunk', 'bark')
    rings = [[mesh.vertex(r * math.cos(TAU * i / 16), r * math.sin(TAU * i / 16), z) for i in range(16)]
             for z, r in ((0, 0.25), (0.3, 0.18), (2.2, 0.14), (5.5, 0.03))]
    mesh.rows(rings, closed=True)
    mesh.facet('leaves', 'foliage')
    for _ in range(6000):
        while True:                          # even over a ball, denser towards its skin
            p = [rng.uniform(-1, 1) for _ in range(3)]
            r = math.sqrt(sum(c * c for c in p))
            if 0.4 < r < 1 and rng.random() < r * r:
                break
        x, y, z = 2.3 * p[0], 2.3 * p[1], 4.7 + 2.3 * p[2]
        u = [rng.gauss(0, 1) for _ in range(3)]
        v = [rng.gauss(0, 1) for _ in range(3)]
        size = 0.16 / math.sqrt(sum(c * c for c in u))
        across = [0.45 * size * (v[i] - u[i] * sum(a * b for a, b in zip(u, v)) / sum(c * c for c in u)) for i in range(3)]
        along = [size * c for c in u]
        mesh.quad((x - along[0], y - along[1], z - along[2]), (x + across[0], y + across[1], z + across[2]),
                  (x + along[0], y + along[1], z + along[2]), (x - across[0], y - across[1], z - across[2]))
    return mesh


# ---------------------------------------------------------------- the scene
LACQUERS = ('black-lacquer', 'white-lacquer', 'silver', 'red-paint')


def scene(rng: random.Random) -> dict[str, Any]:
    """The scene file. Which stalls are taken, and by which car, is drawn; so is how each driver parked."""
    cars: dict[str, list[dict[str, Any]]] = {name: [] for name in LACQUERS}
    count = 0
    for row in ROWS:
        for stall in range(-15, 15):
            if rng.random() > 0.36:
                continue
            count += 1
            x, y = (stall + 0.5) * STALL + rng.gauss(0, 0.1), row + rng.gauss(0, 0.15)
            heading = (0 if rng.random() < 0.5 else 180) + rng.gauss(0, 1.2)
            cars[rng.choice(LACQUERS)].append({
                'facet_prefix': f'car-{count:02d}.', 'rotate_deg': [0, 0, round(heading, 2)],
                'translate_m': [round(x, 2), round(y, 2), round(lot_height(x, y), 3)]})
    trees = [{'facet_prefix': f'tree-{i + 1:02d}.', 'scale': round(rng.uniform(0.8, 1.2), 2),
              'rotate_deg': [0, 0, round(rng.uniform(0, 360), 1)],
              'translate_m': [round(side * 44 + rng.gauss(0, 0.5), 2), round(y + rng.gauss(0, 1), 2), -0.3]}
             for i, (side, y) in enumerate((side, y) for side in (-1, 1) for y in (-24, -8, 8, 24))]
    folder = 'generated/parking-lot/'
    geometry: list[dict[str, Any]] = [{'obj': folder + name + '.obj'} for name in ('lot', 'building', 'pond', 'lawn')]
    geometry += [{'obj': folder + 'car.obj', 'materials': {'body': name}, 'instances': places} for name, places in cars.items() if places]
    geometry += [{'obj': folder + 'tree.obj', 'instances': trees}, {'ground': {'z_m': -0.3, 'material': 'soil', 'facet': 'ground'}}]

    def colour(name: str) -> Any:
        return {'model': 'lambertian', 'reflectance': {'file': f'data/{name}.csv', 'column': 'reflectance'}}

    def surface(constants: str, sigma: float) -> dict[str, Any]:
        return {'model': 'torrance-sparrow', 'optical_constants': f'data/{constants}.yml', 'sigma': sigma, 'diffuse': 'none'}

    return {
        'malus': 1, 'title': 'A parking lot', 'bands': {'wavelength_nm': [450, 550, 650]}, 'geometry': geometry,
        'materials': {
            'asphalt': colour('asphalt'), 'concrete': colour('concrete'), 'grass': colour('grass'), 'soil': colour('soil'),
            'foliage': colour('foliage'), 'paint': {'model': 'lambertian', 'reflectance': 0.7},
            'bark': {'model': 'lambertian', 'reflectance': 0.1}, 'tyre': {'model': 'lambertian', 'reflectance': 0.04},
            'red-paint': {'model': 'lambertian',
                          'reflectance': {'wavelength_nm': [360, 560, 620, 800], 'values': [0.04, 0.05, 0.5, 0.6]}},
            'black-lacquer': {'model': 'torrance-sparrow', 'n': 1.5, 'k': 0, 'sigma': 0.03, 'diffuse': 'none'},
            'white-lacquer': {'model': 'torrance-sparrow', 'n': 1.5, 'k': 0, 'sigma': 0.05, 'diffuse': 'thesis'},
            'silver': surface('aluminium-rakic', 0.15), 'chrome': surface('aluminium-rakic', 0.05),
            'glass': surface('glass', 0.02), 'water': surface('water', 0.03), 'still-water': surface('water', 0.01)},
        'sun': {'latitude_deg': 43.16, 'longitude_deg': -77.61, 'time': '2001-06-10T10:00:00-04:00'},
        'sky': {'model': 'uniform', 'radiance_W_m2_sr_nm': 0.1},
        'sensor': {'kind': 'framing', 'width': 480, 'height': 320, 'field_of_view_deg': 58, 'samples_per_pixel': 4, 'jitter': True},
        'platform': {'position_m': [14, -78, 21], 'look_at_m': [-1, 0, 1], 'up': [0, 0, 1]},
        'radiometry': {'sampling': 'importance', 'rays': [8, 2, 1], 'seed': 1}}


def readable(value: Any) -> str:
    """JSON with one line for each instance, material and other small thing."""
    def dump(item: Any, indent: int) -> str:
        short = json.dumps(item)
        if len(short) + indent < 118 or not isinstance(item, (dict, list)):
            return short
        pad = '\n' + ' ' * (indent + 2)
        if isinstance(item, list):
            return '[' + pad + (',' + pad).join(dump(x, indent + 2) for x in item) + '\n' + ' ' * indent + ']'
        return '{' + pad + (',' + pad).join(f'{json.dumps(k)}: {dump(x, indent + 2)}' for k, x in item.items()) + '\n' + ' ' * indent + '}'
    return ('// A parking lot of about a million triangles; made by parking-lot.py, which also makes its meshes: run that first.\n'
            + dump(value, 0) + '\n')


def main() -> None:
    here = pathlib.Path(__file__).resolve().parent
    options = argparse.ArgumentParser(description=(__doc__ or '').split('\n', maxsplit=1)[0])
    options.add_argument('--out', type=pathlib.Path, default=here / 'generated' / 'parking-lot', help='directory of the meshes')
    options.add_argument('--scene', type=pathlib.Path, default=here / 'parking-lot.json', help='the scene file')
    options.add_argument('--seed', type=int, default=1)
    given = options.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    total = {}
    for make in (lot, building, pond, lawn, car, tree):
        mesh = make(random.Random(f'{given.seed} {make.__name__}'))
        mesh.save(given.out / (make.__name__ + '.obj'))
        total[make.__name__ + '.obj'] = mesh.triangles
    made = scene(random.Random(f'{given.seed} scene'))
    given.scene.write_text(readable(made))
    count = sum(total[item['obj'].rsplit('/', 1)[1]] * len(item.get('instances', [1])) for item in made['geometry'] if 'obj' in item)
    print(f'{given.scene}: {count} triangles in the scene')


if __name__ == '__main__':
    main()
