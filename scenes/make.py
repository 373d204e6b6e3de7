"""Makes spheres, cornell, cornell-spheres, balls, far, leaves and book/*. The same seed gives the same scenes."""

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


def write(name, camera, sky, materials, numbers=None, **lists):
    parts = ['  "format": "octray-1"', f'  "camera": {json.dumps(camera)}']
    # A point in the middle, as these scenes are looked at from all sides.
    parts += [f'  "origin": {json.dumps(camera["look_at"])}', f'  "sky": {json.dumps(sky)}']
    parts += [f'  "{key}": {json.dumps(value)}' for key, value in (numbers or {}).items()]
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


def make_far():
    # A unit sphere on a folded fan of thin triangles, 7,000 radii from the camera: naive methods lose it.
    materials = {
        "clay": {"type": "diffuse", "color": [0.8, 0.42, 0.25]},
        "paper": {"type": "diffuse", "color": [0.15, 0.3, 0.5]},
    }
    folds = 72

    def rim(i):
        turn = 2 * math.pi * (i % folds) / folds
        return rounded(2.6 * math.cos(turn), -0.85 if i % 2 else -1.15, 2.6 * math.sin(turn))

    fan = [{"vertices": [[0, -1, 0], rim(i + 1), rim(i)], "material": "paper"} for i in range(folds)]
    camera = {"position": [3000, 2000, 6000], "look_at": [0, -0.1, 0], "vertical_fov": 0.026}
    sky = {"gradient": {"bottom": [0.6, 0.55, 0.5], "top": [0.8, 0.9, 1.1]}}
    ball = {"center": [0, 0, 0], "radius": 1, "material": "clay"}
    write("far.json", camera, sky, materials, spheres=[ball], triangles=fan)


def make_book_final():
    # The final scene of "Ray Tracing in One Weekend", with random numbers of our own.
    rng = random.Random(SEED)
    materials = {
        "ground": {"type": "diffuse", "color": [0.5, 0.5, 0.5]},
        "glass": {"type": "glass", "ior": 1.5},
        "brown": {"type": "diffuse", "color": [0.4, 0.2, 0.1]},
        "mirror": {"type": "metal", "color": [0.7, 0.6, 0.5]},
    }
    spheres = [{"center": [0, -1000, 0], "radius": 1000, "material": "ground"}]
    for a in range(-11, 11):
        for b in range(-11, 11):
            kind = rng.random()
            center = rounded(a + 0.9 * rng.random(), 0.2, b + 0.9 * rng.random())
            if math.dist(center, (4, 0.2, 0)) <= 0.9:
                continue
            name = "glass" if kind >= 0.95 else f"{len(spheres)}"
            if kind < 0.8:
                color = rounded(*(rng.random() * rng.random() for _ in range(3)))
                materials[name] = {"type": "diffuse", "color": color}
            elif kind < 0.95:
                color = rounded(*(rng.uniform(0.5, 1) for _ in range(3)))
                fuzz = round(rng.uniform(0, 0.5), 4)
                materials[name] = {"type": "scatter", "color": color, "roughness": fuzz}
            spheres.append({"center": center, "radius": 0.2, "material": name})
    for x, material in ((0, "glass"), (-4, "brown"), (4, "mirror")):
        spheres.append({"center": [x, 1, 0], "radius": 1, "material": material})
    camera = {"position": [13, 2, 3], "look_at": [0, 0, 0], "vertical_fov": 20}
    sky = {"gradient": {"bottom": [1, 1, 1], "top": [0.5, 0.7, 1]}}
    numbers = {"resolution": [480, 270], "max_bounces": 49}
    write("book/final.json", camera, sky, materials, numbers, spheres=spheres)


def make_book_defocus():
    # The final scene through the book's lens of 0.6 degrees.
    lens = {"aperture_radius": round(10 * math.tan(math.radians(0.3)), 6), "focus_distance": 10}
    view = {"format": "octray-view-1", "scene": "final.json", "camera": lens}
    parts = [f'  {json.dumps(key)}: {json.dumps(value)}' for key, value in view.items()]
    (HERE / "book/defocus.json").write_text("{\n" + ",\n".join(parts) + "\n}\n")


def make_book_materials():
    # A sphere of each material in a row, under one lamp.
    materials = {
        "floor": {"type": "diffuse", "color": [0.5, 0.5, 0.5]},
        "lamp": {"type": "emitter", "emission": [9, 8.5, 8]},
        "diffuse": {"type": "diffuse", "color": [0.75, 0.42, 0.28]},
        "metal": {"type": "metal", "color": [0.95, 0.72, 0.35]},
        "metal 0.4": {"type": "metal", "color": [0.95, 0.72, 0.35], "roughness": 0.4},
        "metal-rough": {"type": "metal-rough", "color": [0.25, 0.5, 0.3], "roughness": 0.4, "metallic": 0.5},
        "plastic": {"type": "plastic", "color": [0.1, 0.22, 0.62], "roughness": 0.1},
        "glass": {"type": "glass", "ior": 1.5},
        "air in glass": {"type": "glass", "ior": 0.6667},
        "scatter": {"type": "scatter", "color": [0.8, 0.85, 0.8], "roughness": 0.3},
        "emitter": {"type": "emitter", "emission": [1.1, 0.8, 0.35]},
    }
    row = ["diffuse", "metal", "metal 0.4", "metal-rough", "plastic", "glass", "glass", "scatter", "emitter"]
    spheres = [{"center": [0, -1000, 0], "radius": 1000, "material": "floor"}]
    spheres.append({"center": [-4, 9, 6], "radius": 2, "material": "lamp"})
    for i, material in enumerate(row):
        spheres.append({"center": [round(1.1 * (i - 4), 4), 0.5, 0], "radius": 0.5, "material": material})
    spheres.append({"center": [2.2, 0.5, 0], "radius": 0.46, "material": "air in glass"})
    camera = {"position": [0, 2.4, 16], "look_at": [0, 0.45, 0], "vertical_fov": 6}
    sky = {"gradient": {"bottom": [0.3, 0.3, 0.3], "top": [0.5, 0.6, 0.8]}}
    numbers = {"resolution": [720, 120], "max_bounces": 16}
    write("book/materials.json", camera, sky, materials, numbers, spheres=spheres)


def make_leaves():
    rng = random.Random(SEED)
    materials = {
        "floor": {"type": "diffuse", "color": [0.75, 0.72, 0.68]},
        "leaf": {
            "type": "diffuse", "color": [1, 1, 1], "texture": "textures/leaf.png",
            "opacity_map": "textures/leaf.png", "alpha_cutoff": 0.5,
        },
        "autumn": {
            "type": "diffuse", "color": [1, 0.55, 0.25], "texture": "textures/leaf.png",
            "opacity_map": "textures/leaf.png", "alpha_cutoff": 0.5,
        },
        "veil": {"type": "diffuse", "color": [0.55, 0.7, 0.9], "opacity": 0.35},
        "lamp": {"type": "emitter", "emission": [60, 54, 44]},
    }
    spheres = [
        {"center": [-2.5, 6, 3], "radius": 0.6, "material": "lamp"},
        {"center": [1.1, 0.55, 0.6], "radius": 0.55, "material": "veil"},
    ]
    triangles = []

    def card(corners, material):
        a, b, c, d = corners
        for vertices, uvs in ([a, b, c], [[0, 0], [1, 0], [1, 1]]), ([a, c, d], [[0, 0], [1, 1], [0, 1]]):
            triangles.append({"vertices": vertices, "uvs": uvs, "material": material})

    card([[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], "floor")
    for number in range(22):
        foot = [rng.uniform(-1.3, 1.0), rng.uniform(1.0, 1.9), rng.uniform(-0.5, 0.7)]
        turn, lean, size = rng.uniform(0, 2 * math.pi), rng.uniform(0.3, 1.3), rng.uniform(0.5, 0.8)
        side = [0.375 * size * math.cos(turn), 0, -0.375 * size * math.sin(turn)]
        out, down = size * math.sin(lean), size * math.cos(lean)
        tip = [out * math.sin(turn), -down, out * math.cos(turn)]
        corners = [(-1, 0), (1, 0), (1, 1), (-1, 1)]
        at = lambda s, t: rounded(*(foot[i] + s * side[i] + t * tip[i] for i in range(3)))
        card([at(s, t) for s, t in corners], "autumn" if number % 5 == 0 else "leaf")
    camera = {"position": [0.6, 1.9, 5.5], "look_at": [0, 0.95, 0], "vertical_fov": 34}
    sky = {"gradient": {"bottom": [0.35, 0.35, 0.35], "top": [0.45, 0.55, 0.75]}}
    write("leaves.json", camera, sky, materials, spheres=spheres, triangles=triangles)


if __name__ == "__main__":
    make_spheres()
    make_cornell()
    make_balls()
    make_far()
    make_leaves()
    (HERE / "book").mkdir(exist_ok=True)
    make_book_final()
    make_book_defocus()
    make_book_materials()
