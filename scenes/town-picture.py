#!/usr/bin/python3
"""The town of town.py at noon in false colour, and at night at 10 um as the temperature of a black body that is as bright.

    malus render scenes/generated/town/town.json --out out
    scenes/town-picture.py out/town.0000.img out/town.0001.img town.png

Needs Python 3, NumPy, Pillow and Matplotlib.
"""
import argparse
import pathlib
import re
from typing import Any

import numpy
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image  # type: ignore[import]  # without stubs

PLANCK_J_S, LIGHT_M_S, BOLTZMANN_J_K = 6.62607015e-34, 299792458.0, 1.380649e-23
RED, GREEN, BLUE, INFRARED = 650.0, 550.0, 450.0, 10000.0   # nm
WIDTH_IN, DOTS_PER_IN, COLOURS = 9.7, 100, 256


def scalar(path: pathlib.Path) -> dict[float, Any]:
    """S0 of each band of a cube by its wavelength in nm."""
    header = pathlib.Path(str(path) + '.hdr').read_text(encoding='utf-8')

    def field(name: str) -> str:
        found = re.search(rf'^{name} = (?:{{([^}}]*)}}|(.*))$', header, re.MULTILINE)
        if not found:
            raise SystemExit(f'{path}.hdr has no "{name}"')
        return found[1] or found[2]
    if field('interleave').strip() != 'bip' or field('data type').strip() != '4':
        raise SystemExit(f'{path}: render with --interleave bip')
    names = [name.strip() for name in field('band names').split(',')]
    lengths = [float(value) for value in field('wavelength').split(',')]
    cube = numpy.fromfile(path, '<f4').reshape(int(field('lines')), int(field('samples')), len(names))
    return {length: cube[..., i] for i, (name, length) in enumerate(zip(names, lengths)) if name.startswith('S0')}


def brightness_kelvin(radiance: Any, wavelength_nm: float) -> Any:
    """Temperature of a black body of this radiance, W/(m^2 sr nm)."""
    metres = wavelength_nm * 1e-9
    brightest = 2 * PLANCK_J_S * LIGHT_M_S ** 2 / metres ** 5 * 1e-9
    return PLANCK_J_S * LIGHT_M_S / (metres * BOLTZMANN_J_K) / numpy.log1p(brightest / radiance)


def false_colour(light: dict[float, Any]) -> Any:
    """Red, green and blue as on a screen; all bands have one white, and the brightest percent is cut."""
    bands = [light[length] for length in (RED, GREEN, BLUE)]
    white = max(numpy.percentile(band, 99) for band in bands)
    return numpy.clip(numpy.dstack(bands) / white, 0, 1) ** (1 / 2.2)


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or '').split('\n', maxsplit=1)[0])
    options.add_argument('noon', type=pathlib.Path, help='cube of the first picture')
    options.add_argument('night', type=pathlib.Path, help='cube of the second')
    options.add_argument('png', type=pathlib.Path, help='picture to write')
    given = options.parse_args()
    celsius = brightness_kelvin(scalar(given.night)[INFRARED], INFRARED) - 273.15
    lines, samples = celsius.shape
    width = (WIDTH_IN - 1.1) / 2
    height = width * lines / samples
    figure = Figure(figsize=(WIDTH_IN, height + 0.35), dpi=DOTS_PER_IN)
    canvas = FigureCanvasAgg(figure)
    boxes = [figure.add_axes((x / WIDTH_IN, 0.05 / (height + 0.35), w / WIDTH_IN, height / (height + 0.35)))
             for x, w in ((0.05, width), (0.15 + width, width), (0.25 + 2 * width, 0.15))]
    boxes[0].imshow(false_colour(scalar(given.noon)))
    low, high = numpy.percentile(celsius, (1, 99.5))
    image = boxes[1].imshow(celsius, cmap='inferno', vmin=low, vmax=high)
    for box, title in zip(boxes, ('noon, 650, 550 and 450 nm', 'night, 10 µm')):
        box.set_title(title, fontsize=9)
        box.set_axis_off()
    figure.colorbar(image, cax=boxes[2]).ax.tick_params(labelsize=8)
    boxes[2].set_title('°C', fontsize=9)
    canvas.draw()
    Image.fromarray(numpy.asarray(canvas.buffer_rgba())).convert('RGB').quantize(COLOURS).save(given.png, optimize=True)


if __name__ == '__main__':
    main()
