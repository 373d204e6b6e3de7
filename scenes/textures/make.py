"""Makes the pictures of the scenes: sky.jpg, chess.png and leaf.png, beside this file.

Needs numpy and Pillow. The same seed gives the same pictures.
"""

from pathlib import Path

import numpy as np
from PIL import Image

HERE = Path(__file__).parent
SEED = 20250
WIDTH, HEIGHT = 1024, 512
SUN = np.array([-0.55, 0.42, 0.72])


def noise(points, frequency, seed):
    """Smooth value noise on points in space: on a sphere of directions it has no seam and no poles."""
    p = points * frequency + seed * 17.31
    cell = np.floor(p).astype(np.int64)
    f = p - cell
    f = f * f * f * (f * (f * 6 - 15) + 10)
    total = 0
    for dx in (0, 1):
        for dy in (0, 1):
            for dz in (0, 1):
                c = cell + np.array([dx, dy, dz])
                h = (c[..., 0] * 73856093) ^ (c[..., 1] * 19349663) ^ (c[..., 2] * 83492791) ^ (seed * 2654435761)
                h = (h ^ (h >> 13)) * 1274126177 & 0xFFFFFFFF
                h = ((h ^ (h >> 16)) & 0xFFFF) / 65535.0
                wx = f[..., 0] if dx else 1 - f[..., 0]
                wy = f[..., 1] if dy else 1 - f[..., 1]
                wz = f[..., 2] if dz else 1 - f[..., 2]
                total = total + h * wx * wy * wz
    return total


def fractal(points, frequency, octaves, seed):
    total, weight = 0, 0
    for octave in range(octaves):
        total = total + noise(points, frequency * 2**octave, seed + octave) * 0.5**octave
        weight += 0.5**octave
    return total / weight


def smooth(low, high, x):
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def mix(a, b, t):
    return np.asarray(a) * (1 - t[..., None]) + np.asarray(b) * t[..., None]


def save_sky():
    # Column and row centres as directions: u = atan2(z, x) / 2 pi, row = acos(y) / pi.
    phi = (np.arange(WIDTH) + 0.5) / WIDTH * 2 * np.pi
    theta = (np.arange(HEIGHT) + 0.5) / HEIGHT * np.pi
    phi, theta = np.meshgrid(phi, theta)
    d = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=-1)
    y = d[..., 1]
    sun = SUN / np.linalg.norm(SUN)
    toward_sun = np.clip(d @ sun, -1, 1)

    # Display colours: deep blue above, pale towards the horizon, warm around the sun.
    sky = mix([0.80, 0.87, 0.93], [0.44, 0.66, 0.90], smooth(0.0, 0.35, y))
    sky = mix(sky, [0.16, 0.37, 0.70], smooth(0.25, 1.0, y))
    sky = mix(sky, [1.0, 0.93, 0.80], 0.55 * np.clip(toward_sun, 0, 1) ** 24)
    sky = mix(sky, [1.0, 0.97, 0.90], 0.7 * np.clip(toward_sun, 0, 1) ** 180)

    # Clouds live on a flat layer: looked at from below they shrink towards the horizon.
    layer = d / np.maximum(y, 0.045)[..., None] * 0.9
    layer[..., 1] = 0.0
    bend = fractal(layer, 0.7, 3, SEED % 97 + 31)[..., None] * 1.2
    density = fractal(layer + bend, 1.1, 6, SEED % 97)
    cover = smooth(0.50, 0.72, density) * smooth(0.02, 0.16, y)
    shade = smooth(0.52, 0.86, density)
    cloud = mix([1.0, 0.995, 0.985], [0.72, 0.76, 0.83], shade)
    cloud = mix(cloud, [1.0, 0.96, 0.88], 0.5 * np.clip(toward_sun, 0, 1) ** 6)
    sky = mix(sky, cloud, 0.92 * cover)
    sky = mix(sky, [1.0, 1.0, 0.97], smooth(0.9988, 0.9994, toward_sun))

    # Below the horizon: hills of haze, then ground.
    ground = mix([0.60, 0.62, 0.55], [0.33, 0.36, 0.27], smooth(0.0, 0.5, -y))
    grain = fractal(d, 14.0, 5, SEED % 97 + 61) - 0.5
    ground = ground * (1 + 0.35 * grain * smooth(0.02, 0.3, -y))[..., None]
    ridge = 0.13 * (fractal(d * [1, 0, 1], 3.0, 5, SEED % 97 + 5) - 0.35)
    hills = mix([0.62, 0.71, 0.78], [0.50, 0.58, 0.60], smooth(0.0, 0.06, ridge - y))
    picture = mix(sky, hills, smooth(-0.0025, 0.0025, ridge - y))
    picture = mix(picture, ground, smooth(0.0, 0.05, -y - 0.01))
    picture = mix(picture, [0.80, 0.85, 0.88], 0.45 * np.exp(-((y / 0.05) ** 2)))

    # Half a grey step of noise hides the bands of the gradient.
    dither = np.random.default_rng(SEED).uniform(-0.5, 0.5, picture.shape)
    data = np.clip(picture * 255 + dither + 0.5, 0, 255).astype(np.uint8)
    Image.fromarray(data).save(HERE / "sky.jpg", quality=88, optimize=True)


def save_chess(side=512, squares=8):
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    square = side // squares
    column, row = x // square, y // square
    light = (column + row) % 2 == 0
    # Every square is its own piece of stone: the veins start somewhere else in each.
    shift = (column * 31 + row * 17)[..., None]
    p = np.stack([x / side, y / side, np.zeros_like(x, dtype=float)], axis=-1) * 4 + shift * 3.7
    veins = fractal(p, 1.3, 5, SEED % 89)
    lines = 1 - np.abs(np.sin((p[..., 0] + p[..., 1] + 3.0 * veins) * 3.0))
    white = mix([0.93, 0.91, 0.86], [0.80, 0.77, 0.71], smooth(0.75, 1.0, lines) * 0.7 + 0.3 * veins)
    black = mix([0.13, 0.12, 0.12], [0.34, 0.31, 0.29], smooth(0.88, 1.0, lines) * 0.6 + 0.25 * veins)
    data = np.where(light[..., None], white, black)
    Image.fromarray(np.clip(data * 255 + 0.5, 0, 255).astype(np.uint8)).quantize(
        64, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE
    ).save(HERE / "chess.png", optimize=True)


def save_leaf(width=96, height=128, samples=4):
    # The stem is below; every pixel is the mean of several points.
    x = (np.arange(width * samples) + 0.5) / (width * samples) * 2 - 1
    y = 1 - (np.arange(height * samples) + 0.5) / (height * samples)
    x, y = np.meshgrid(x, y)
    along = np.clip((y - 0.16) / 0.8, 0, 1)
    teeth = 0.035 * (1 - 2 * np.abs(along * 11 % 1 - 0.5))
    half = (0.78 * np.sin(np.pi * along**0.8) ** 0.9 + teeth) * (along > 0) * (along < 1)
    stem = (np.abs(x) < 0.035) & (y < 0.2)
    inside = (np.abs(x) < half) | stem
    # Veins rise from the middle rib to the edge.
    vein = np.minimum(np.abs(x) * 3, np.abs((along * 7 - np.abs(x) * 2.2 + 0.5) % 1 - 0.5) * 0.6)
    blade = mix([0.30, 0.52, 0.13], [0.16, 0.36, 0.10], np.abs(x))
    color = mix([0.55, 0.68, 0.30], blade, smooth(0.02, 0.09, vein))
    picture = np.concatenate([color, inside[..., None].astype(float)], axis=-1)
    picture = picture.reshape(height, samples, width, samples, 4).mean(axis=(1, 3))
    Image.fromarray((picture * 255 + 0.5).astype(np.uint8)).save(HERE / "leaf.png", optimize=True)


if __name__ == "__main__":
    save_sky()
    save_chess()
    save_leaf()
