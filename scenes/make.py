"""Makes spheres.json, cornell.json, cornell-spheres.json and balls.json beside this file. The same seed gives the same scenes."""

import json
import math
import random
from pathlib import Path

HERE = Path(__file__).parent
SEED = 7


def entries(items):
    return "[\n    " + ",\n    ".join(json.dumps(item) for item in items) + "\n  ]"


def named(items):
    return "{\n    " + ",\n    ".join(f"{json.dumps(k)}: {json.dumps(v)}" for k, v in items.items()) + "\n  }"


def write(name, camera, sky, materials, **lists):
    parts = ['  "format": "octray-1"', f'  "camera": {json.dumps(camera)}', f'  "sky": {json.dumps(sky)}']
    parts.append(f'  "materials": {named(materials)}')
    parts += [f'  "{key}": {entries(items)}' for key, items in lists.items()]
    (HERE / name).write_text("{\n" + ",\n".join(parts) + "\n}\n")


def rounded(*numbers):
    return [round(x, 4) for x in numbers]


def make_spheres():
    rng = random.Random(SEED)
    materials = {
        "floor": {"type": "diffuse", "color": [0.45, 0.45, 0.48]},
        "lamp": {"type": "emitter", "emission": [6, 5, 3.7]},
        "moon": {"type": "emitter", "emission": [2.6, 3.6, 5]},
        "mirror": {"type": "metal", "color": [0.95, 0.95, 0.95]},
        "gold": {"type": "metal", "color": [0.95, 0.72, 0.35], "roughness": 0.15},
        "copper": {"type": "metal", "color": [0.92, 0.55, 0.42], "roughness": 0.35},
        "steel": {"type": "metal", "color": [0.65, 0.67, 0.7], "roughness": 0.6},
        "glass": {"type": "glass", "ior": 1.5},
        "green glass": {"type": "glass", "color": [0.75, 0.95, 0.8], "ior": 1.5},
        "red": {"type": "diffuse", "color": [0.75, 0.15, 0.12]},
        "orange": {"type": "diffuse", "color": [0.85, 0.45, 0.12]},
        "green": {"type": "diffuse", "color": [0.2, 0.55, 0.2]},
        "blue": {"type": "diffuse", "color": [0.15, 0.25, 0.65]},
        "white": {"type": "diffuse", "color": [0.8, 0.8, 0.78]},
    }
    # The floor's top is at y = 0; the lights hang to the left and to the right.
    spheres = [
        {"center": [0, -1000, 0], "radius": 1000, "material": "floor"},
        {"center": [-5.5, 6.5, 2], "radius": 2.2, "material": "lamp"},
        {"center": [7, 5.6, -4], "radius": 1.8, "material": "moon"},
        {"center": [-1.9, 1.1, -0.6], "radius": 1.1, "material": "mirror"},
        {"center": [0.5, 1.0, 0.4], "radius": 1.0, "material": "glass"},
        {"center": [2.6, 0.9, -1.0], "radius": 0.9, "material": "gold"},
    ]
    kinds = [name for name in materials if name not in ("floor", "lamp", "moon")]
    while len(spheres) < 50:
        radius = rng.uniform(0.22, 0.55)
        angle, distance = rng.uniform(0, 2 * math.pi), 6.2 * math.sqrt(rng.random())
        x, z = distance * math.cos(angle), distance * math.sin(angle)
        # Resting on the floor's curve.
        y = math.sqrt((1000 + radius) ** 2 - x * x - z * z) - 1000
        free = all(
            math.dist((x, y, z), ball["center"]) > radius + ball["radius"] + 0.06 for ball in spheres[1:]
        )
        in_view = math.hypot(x, z - 9.5) > 4.5
        if free and in_view:
            kind = kinds[(len(spheres) * 5) % len(kinds)]
            spheres.append({"center": rounded(x, y, z), "radius": round(radius, 4), "material": kind})
    camera = {"position": [0.4, 2.6, 9.5], "look_at": [0.2, 0.75, 0], "vertical_fov": 36}
    sky = {"gradient": {"bottom": [0.10, 0.09, 0.10], "top": [0.12, 0.18, 0.34]}}
    write("spheres.json", camera, sky, materials, spheres=spheres)


def quad(a, b, c, d, material):
    """Two triangles of a flat four-cornered piece."""
    return [
        {"vertices": [a, b, c], "material": material},
        {"vertices": [a, c, d], "material": material},
    ]


def block(x, z, half, height, degrees, material):
    """A block that stands on the floor: four sides and a top."""
    turn = math.radians(degrees)
    foot = []
    for sx, sz in ((-1, 1), (1, 1), (1, -1), (-1, -1)):
        foot.append((x + half * (sx * math.cos(turn) + sz * math.sin(turn)),
                     z + half * (sz * math.cos(turn) - sx * math.sin(turn))))
    low = [rounded(px, 0, pz) for px, pz in foot]
    high = [rounded(px, height, pz) for px, pz in foot]
    triangles = quad(*high, material)
    for i in range(4):
        j = (i + 1) % 4
        triangles += quad(low[i], low[j], high[j], high[i], material)
    return triangles


def make_cornell():
    # A room two wide, two high, two deep; open towards the camera.
    floor = [[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]]
    ceiling = [[-1, 2, -1], [1, 2, -1], [1, 2, 1], [-1, 2, 1]]
    back = [[-1, 0, -1], [1, 0, -1], [1, 2, -1], [-1, 2, -1]]
    left = [[-1, 0, 1], [-1, 0, -1], [-1, 2, -1], [-1, 2, 1]]
    right = [[1, 0, -1], [1, 0, 1], [1, 2, 1], [1, 2, -1]]
    lamp = [[-0.42, 1.99, -0.45], [0.42, 1.99, -0.45], [0.42, 1.99, 0.25], [-0.42, 1.99, 0.25]]
    room = quad(*floor, "white") + quad(*ceiling, "white") + quad(*back, "white")
    room += quad(*left, "red") + quad(*right, "green") + quad(*lamp, "lamp")
    materials = {
        "white": {"type": "diffuse", "color": [0.73, 0.73, 0.73]},
        "red": {"type": "diffuse", "color": [0.63, 0.065, 0.05]},
        "green": {"type": "diffuse", "color": [0.14, 0.45, 0.091]},
        "lamp": {"type": "emitter", "emission": [10, 7.4, 4.2]},
    }
    camera = {"position": [0, 1, 2.45], "look_at": [0, 1, 0], "vertical_fov": 40}
    sky = {"color": [0, 0, 0]}
    blocks = block(-0.36, -0.32, 0.29, 1.2, 18, "white") + block(0.36, 0.22, 0.29, 0.58, -17, "white")
    write("cornell.json", camera, sky, materials, triangles=room + blocks)
    materials |= {
        "mirror": {"type": "metal", "color": [0.95, 0.95, 0.95]},
        "glass": {"type": "glass", "ior": 1.5},
    }
    balls = [
        {"center": [-0.45, 0.42, -0.5], "radius": 0.42, "material": "mirror"},
        {"center": [0.43, 0.36, -0.12], "radius": 0.36, "material": "glass"},
    ]
    write("cornell-spheres.json", camera, sky, materials, spheres=balls, triangles=room)


def make_balls():
    # Ten balls in a field under an even sky: no lamp, and every path that leaves the scene finds light.
    materials = {
        "field": {"type": "diffuse", "color": [0.5, 0.44, 0.3]},
        "mirror": {"type": "metal", "color": [0.92, 0.92, 0.92]},
        "brass": {"type": "metal", "color": [0.9, 0.7, 0.38]},
        "glass": {"type": "glass", "ior": 1.5},
        "red": {"type": "diffuse", "color": [0.72, 0.16, 0.12]},
        "ochre": {"type": "diffuse", "color": [0.8, 0.5, 0.14]},
        "blue": {"type": "diffuse", "color": [0.14, 0.26, 0.6]},
        "white": {"type": "diffuse", "color": [0.8, 0.8, 0.78]},
    }
    # x, z and radius: each rests on the field.
    places = [
        (-1.45, -0.5, 1.0, "mirror"), (0.55, -0.9, 0.85, "red"), (0.1, 0.95, 0.5, "glass"), (2.3, -0.25, 0.7, "glass"),
        (-3.3, -1.3, 0.75, "ochre"), (1.35, 0.95, 0.38, "blue"), (-1.2, 1.35, 0.36, "white"), (-2.6, 0.85, 0.42, "brass"),
        (3.2, 1.05, 0.36, "red"), (2.2, -2.9, 0.9, "white"),
    ]
    balls = [{"center": [x, r, z], "radius": r, "material": material} for x, z, r, material in places]
    field = quad([-60, 0, 60], [60, 0, 60], [60, 0, -60], [-60, 0, -60], "field")
    camera = {"position": [0.5, 2.2, 7.2], "look_at": [0.05, 0.5, 0], "vertical_fov": 34}
    sky = {"color": [0.7, 0.82, 1.0]}
    write("balls.json", camera, sky, materials, spheres=balls, triangles=field)


if __name__ == "__main__":
    make_spheres()
    make_cornell()
    make_balls()
