"""Writes nine glTF models of different kinds, with the standard library alone.

    python3 perf/peers/blender/models.py FOLDER

| model | what it holds |
|---|---|
| grid.gltf + grid.bin | spheres of metallic 0, ½ and 1 by roughness 0.1 to 1, on a floor; a camera |
| textured.glb | images in the file: base colour, metallic-roughness, normal map; texture transforms |
| lamps.gltf | data URIs; a closed room lit by emissive surfaces, one with a texture, and emissive strength |
| glass.glb | clear, tinted and dense glass: transmission, volume and index of refraction; a mirrored scale |
| thin.glb | thin-walled panes: transmission without volume; an unlit card |
| tree.gltf | a tree of nodes: instances, mirrored and unequal scales; strips and fans, sparse and quantised numbers, vertex colours, 8-bit indices |
| leaves.glb | cut-outs (MASK) with alpha in a texture, a veil (BLEND), an orthographic camera |
| punctual.gltf | a point, a spot and a directional light, no sky to speak of |
| frosted.glb | rough glass of three roughnesses |
"""

import base64
import json
import math
import struct
import sys
import zlib
from pathlib import Path

FLOAT, U32, U16, U8, I16 = 5126, 5125, 5123, 5121, 5122
FORMATS = {FLOAT: "f", U32: "I", U16: "H", U8: "B", I16: "h"}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


class Model:
    def __init__(self):
        self.binary = bytearray()
        self.json = {"asset": {"version": "2.0", "generator": "octray perf/peers/blender"}, "scene": 0}
        self.json["scenes"] = [{"nodes": []}]

    def add(self, key, value):
        self.json.setdefault(key, []).append(value)
        return len(self.json[key]) - 1

    def view(self, data, stride=None):
        while len(self.binary) % 4:
            self.binary.append(0)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if stride:
            view["byteStride"] = stride
        self.binary += data
        return self.add("bufferViews", view)

    def accessor(self, rows, component=FLOAT, normalized=False, sparse=None):
        size = len(rows[0])
        width = struct.calcsize(FORMATS[component]) * size
        stride = -(-width // 4) * 4 if size > 1 else width
        pack = lambda row: struct.pack(f"<{size}{FORMATS[component]}", *row).ljust(stride, b"\0")
        accessor = {"bufferView": self.view(b"".join(map(pack, rows)), stride if size > 1 else None)}
        accessor |= {"componentType": component, "count": len(rows), "type": TYPES[size]}
        if normalized:
            accessor["normalized"] = True
        shown = list(rows)
        if sparse:
            indices, values = zip(*sorted(sparse.items()))
            for index, value in sparse.items():
                shown[index] = value
            accessor["sparse"] = {
                "count": len(indices),
                "indices": {"bufferView": self.view(struct.pack(f"<{len(indices)}H", *indices)), "componentType": U16},
                "values": {"bufferView": self.view(b"".join(map(pack, values)))},
            }
        if size == 3:
            accessor |= {"min": list(map(min, zip(*shown))), "max": list(map(max, zip(*shown)))}
        return self.add("accessors", accessor)

    def primitive(self, points, indices, material, normals=None, uvs=None, index_type=U32, mode=4, **attributes):
        attributes["POSITION"] = points if isinstance(points, int) else self.accessor(points)
        if normals:
            attributes["NORMAL"] = self.accessor(normals)
        if uvs:
            attributes["TEXCOORD_0"] = self.accessor(uvs)
        primitive = {"attributes": attributes, "material": material, "mode": mode}
        if indices:
            primitive["indices"] = self.accessor([(index,) for index in indices], index_type)
        return primitive

    def ball(self, mapped=False):
        """A primitive but for its material: the unit sphere."""
        points, uvs, indices = sphere()
        attributes = {"POSITION": self.accessor(points)} | ({"TEXCOORD_0": self.accessor(uvs)} if mapped else {})
        attributes["NORMAL"] = attributes["POSITION"]
        return {"attributes": attributes, "indices": self.accessor([(index,) for index in indices], U16)}

    def mesh(self, *primitives):
        return self.add("meshes", {"primitives": list(primitives)})

    def node(self, root=True, **keys):
        node = self.add("nodes", keys)
        if root:
            self.json["scenes"][0]["nodes"].append(node)
        return node

    def camera(self, position, target, fov=None, height=None):
        """`height` gives an orthographic camera that sees so much."""
        perspective = {"yfov": math.radians(fov or 1), "znear": 0.01, "aspectRatio": 16 / 9}
        flat = {"xmag": (height or 1) / 2 * 16 / 9, "ymag": (height or 1) / 2, "znear": 0.01, "zfar": 100}
        self.add("cameras", {"type": "orthographic", "orthographic": flat} if height else {"type": "perspective", "perspective": perspective})
        back = unit([a - b for a, b in zip(position, target)])
        right = unit(cross([0, 1, 0], back))
        up = cross(back, right)
        self.node(camera=0, matrix=[*right, 0, *up, 0, *back, 0, *position, 1])

    def material(self, color=(1, 1, 1), metallic=0, roughness=1, alpha=1, **keys):
        pbr = {"baseColorFactor": [*color, alpha], "metallicFactor": metallic, "roughnessFactor": roughness}
        pbr |= keys.pop("pbr", {})
        for name in keys.get("extensions", {}):
            self.use(name)
        return self.add("materials", {"pbrMetallicRoughness": pbr, "doubleSided": True} | keys)

    def use(self, name):
        if name not in self.json.setdefault("extensionsUsed", []):
            self.json["extensionsUsed"].append(name)

    def texture(self, width, height, color, **sampler):
        image = {"bufferView": self.view(png(width, height, color)), "mimeType": "image/png"}
        texture = {"source": self.add("images", image)}
        if sampler:
            texture["sampler"] = self.add("samplers", sampler)
        return self.add("textures", texture)

    def write(self, path, kind):
        """kind: `glb`, `bin` (a file beside the model) or `data` (a data URI)."""
        path = Path(path)
        buffer = {"byteLength": len(self.binary)}
        if kind == "bin":
            buffer["uri"] = path.with_suffix(".bin").name
            path.with_suffix(".bin").write_bytes(self.binary)
        elif kind == "data":
            buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        self.json["buffers"] = [buffer]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        if kind == "glb":
            text += b" " * (-len(text) % 4)
            binary = bytes(self.binary) + b"\0" * (-len(self.binary) % 4)
            chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
            text = struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
        path.write_bytes(text)


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def png(width, height, color):
    """An 8-bit picture; color(x, y) gives the bytes of a texel, three or with alpha four, y downwards."""
    rows = b"".join(b"\0" + bytes(channel for x in range(width) for channel in color(x, y)) for y in range(height))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, 8, 6 if len(color(0, 0)) == 4 else 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def sphere(columns=24, rows=12):
    points, uvs, indices = [], [], []
    for j in range(rows + 1):
        for i in range(columns + 1):
            theta, phi = math.pi * j / rows, 2 * math.pi * i / columns
            points.append((math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi)))
            uvs.append((i / columns, j / rows))
    for j in range(rows):
        for i in range(columns):
            a, b = j * (columns + 1) + i, (j + 1) * (columns + 1) + i
            if j < rows - 1:
                indices += [a, b, b + 1]
            if j:
                indices += [a, b + 1, a + 1]
    return points, uvs, indices


def quad(size, y=0.0):
    points = [(-size, y, size), (size, y, size), (size, y, -size), (-size, y, -size)]
    return points, [(0, 1), (1, 1), (1, 0), (0, 0)], [0, 1, 2, 0, 2, 3]


def box(lower, upper):
    points, normals, indices = [], [], []
    for axis in range(3):
        for side in (0, 1):
            for corner in [(0, 0), (1, 0), (1, 1), (0, 1)]:
                point = [0, 0, 0]
                point[axis] = (lower, upper)[side][axis]
                for other, at in zip([(axis + 1) % 3, (axis + 2) % 3], corner):
                    point[other] = (lower, upper)[at][other]
                points.append(tuple(point))
                normals.append(tuple((2 * side - 1) * (k == axis) for k in range(3)))
            first = len(points) - 4
            turn = [0, 1, 2, 0, 2, 3] if side else [0, 2, 1, 0, 3, 2]
            indices += [first + k for k in turn]
    return points, normals, indices


def grid(folder):
    model = Model()
    ball = model.ball()
    colors = [(0.9, 0.3, 0.1), (0.3, 0.7, 0.9), (1.0, 0.77, 0.34)]
    for row, metallic in enumerate([0, 0.5, 1]):
        for column, roughness in enumerate([0.1, 0.25, 0.5, 0.75, 1.0]):
            mesh = model.mesh(ball | {"material": model.material(colors[row], metallic, roughness)})
            model.node(mesh=mesh, translation=[2.2 * column - 4.4, 1, 2.2 * row - 2.2])
    points, uvs, indices = quad(9)
    model.node(mesh=model.mesh(model.primitive(points, indices, model.material((0.6, 0.6, 0.6), 0, 0.6))))
    model.camera([0, 6, 10], [0, 0.7, 0], 36)
    model.write(folder / "grid.gltf", "bin")


def textured(folder):
    model = Model()
    # No picture is its own mirror image, nor has that one's mean in a corner.
    checker = lambda x, y: (12 * x + 50, 230 - 12 * y, 160 if (x // 2 + y // 2) % 2 else 40)
    rough = lambda x, y: (0, 60 + 6 * (x % 32), 255 if y % 16 < 8 else 0)

    def bumps(x, y):
        dx, dy = 0.05 + 0.2 * math.sin(x * math.pi / 8), 0.2 + 0.15 * math.sin(y * math.pi / 8)
        return tuple(round(127.5 + 127.5 * channel) for channel in unit([dx, dy, 1]))

    # Blender blends display values between texels, the standard linear ones: colours are not blended here.
    nearest = {"magFilter": 9728, "minFilter": 9728}
    color, packed, normal = model.texture(16, 16, checker, **nearest), model.texture(32, 32, rough), model.texture(16, 16, bumps)
    model.use("KHR_texture_transform")
    turned = {"extensions": {"KHR_texture_transform": {"scale": [2, 1], "rotation": 0.4, "offset": [0.2, 0.1]}}}
    info = lambda index, **keys: {"index": index} | keys
    floor = model.material(pbr={"baseColorTexture": info(color, **turned), "metallicFactor": 0, "roughnessFactor": 0.9})
    maps = {"baseColorTexture": info(color), "metallicRoughnessTexture": info(packed), "metallicFactor": 1, "roughnessFactor": 1}
    ball = model.material(pbr=maps)
    bumpy = model.material((0.8, 0.8, 0.75), 0, 0.4, normalTexture=info(normal, scale=0.7))
    globe = model.ball(mapped=True)
    model.node(mesh=model.mesh(globe | {"material": ball}), translation=[-1.3, 1, 0])
    model.node(mesh=model.mesh(globe | {"material": bumpy}), translation=[1.3, 1, 0], rotation=[0, 0.38268343, 0, 0.92387953])
    points, uvs, indices = quad(6)
    model.node(mesh=model.mesh(model.primitive(points, indices, floor, uvs=uvs)))
    model.camera([0, 2.5, 7], [0, 0.8, 0], 34)
    model.write(folder / "textured.glb", "glb")


def lamps(folder):
    model = Model()
    white, red, green = [model.material(c, 0, 1) for c in [(0.7, 0.7, 0.7), (0.7, 0.1, 0.1), (0.1, 0.6, 0.1)]]
    strength = lambda x: {"KHR_materials_emissive_strength": {"emissiveStrength": x}}
    lamp = model.material((0, 0, 0), 0, 1, emissiveFactor=[1, 0.8, 0.6], extensions=strength(12))
    glow = lambda x, y: (16 * x, 240 - 15 * y, 60)
    picture = {"index": model.texture(16, 16, glow, magFilter=9728, minFilter=9728)}
    panel = model.material((0.4, 0.4, 0.4), 0, 0.7, emissiveFactor=[1, 1, 1], emissiveTexture=picture, extensions=strength(2))
    walls = [
        ([(-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)], white),
        ([(-2, 4, -2), (2, 4, -2), (2, 4, 2), (-2, 4, 2)], white),
        ([(-2, 0, -2), (2, 0, -2), (2, 4, -2), (-2, 4, -2)], white),
        ([(2, 0, 2), (-2, 0, 2), (-2, 4, 2), (2, 4, 2)], white),
        ([(-2, 0, 2), (-2, 0, -2), (-2, 4, -2), (-2, 4, 2)], red),
        ([(2, 0, -2), (2, 0, 2), (2, 4, 2), (2, 4, -2)], green),
        ([(-0.6, 3.98, -0.6), (0.6, 3.98, -0.6), (0.6, 3.98, 0.6), (-0.6, 3.98, 0.6)], lamp),
        ([(-1.2, 1, -1.95), (1.2, 1, -1.95), (1.2, 2.6, -1.95), (-1.2, 2.6, -1.95)], panel),
    ]
    uvs = [(0, 1), (1, 1), (1, 0), (0, 0)]
    parts = [model.primitive(points, [0, 1, 2, 0, 2, 3], material, uvs=uvs) for points, material in walls]
    model.node(mesh=model.mesh(*parts))
    points, normals, indices = box([-0.5, 0, -0.5], [0.5, 1, 0.5])
    block = model.mesh(model.primitive(points, indices, model.material((0.9, 0.9, 0.9), 1, 0.35), normals))
    model.node(mesh=block, translation=[-0.7, 0, 0.4], rotation=[0, 0.25881905, 0, 0.96592583])
    model.node(mesh=block, translation=[0.9, 0, 0.2], scale=[0.7, 1.8, 0.7])
    model.camera([0, 2, 1.9], [0, 1.8, -2], 75)
    model.write(folder / "lamps.gltf", "data")


def glass(folder):
    model = Model()

    def clear(color, ior):
        extensions = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": ior}}
        extensions["KHR_materials_volume"] = {"thicknessFactor": 1}
        return model.material(color, 0, 0, extensions=extensions)

    ball = model.ball()
    for x, color, ior, side in [(-2.2, (1, 1, 1), 1.5, 1), (0, (0.95, 0.8, 0.6), 1.33, -1), (2.2, (0.8, 0.95, 0.85), 2.0, 1)]:
        mesh = model.mesh(ball | {"material": clear(color, ior)})
        model.node(mesh=mesh, translation=[x, 1.01, 0], scale=[1, 1, side])
    points, uvs, indices = quad(6)
    checker = lambda x, y: (220, 220, 220) if (x // 4 + y // 4) % 2 else (60, 60, 70)
    check = model.texture(64, 64, checker, magFilter=9728, minFilter=9728)
    pbr = {"baseColorTexture": {"index": check}, "metallicFactor": 0, "roughnessFactor": 1}
    model.node(mesh=model.mesh(model.primitive(points, indices, model.material(pbr=pbr), uvs=uvs)))
    model.camera([0, 2.2, 7.5], [0, 0.9, 0], 36)
    model.write(folder / "glass.glb", "glb")


def thin(folder):
    model = Model()
    points, uvs, indices = quad(1)
    place = lambda material, **keys: model.node(mesh=model.mesh(model.primitive(points, indices, material, uvs=uvs)), **keys)
    upright, half = math.sqrt(0.5), 0.5
    for x, turn, color, ior in [(-2.3, 0.6, (1, 0.9, 0.6), 1.5), (0, 0.9, (0.6, 0.8, 0.95), 1.5), (2.3, -0.4, (1, 1, 1), 2.2)]:
        extensions = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": ior}}
        sin, cos = upright * math.sin(half * turn), upright * math.cos(half * turn)
        # `compare` makes a sheet of what has this name.
        place(model.material(color, 0, 0, extensions=extensions), name="sheet", translation=[x, 1.1, 0], rotation=[cos, sin, -sin, cos])
    shade = model.texture(16, 16, lambda x, y: (60 + 12 * x, 60 + 12 * y, 150), magFilter=9728, minFilter=9728)
    pbr = {"baseColorTexture": {"index": shade}}
    place(model.material(pbr=pbr, extensions={"KHR_materials_unlit": {}}), translation=[0, 1.5, -3], rotation=[upright, 0, 0, upright])
    place(model.material(pbr=pbr), scale=[6, 1, 6])
    model.camera([0, 2.2, 7.5], [0, 0.9, 0], 36)
    model.write(folder / "thin.glb", "glb")


def tree(folder):
    model = Model()
    # A cone of fans, with vertex colours.
    count = 24
    ring = [(math.cos(2 * math.pi * k / count), 0, -math.sin(2 * math.pi * k / count)) for k in range(count)]
    shades = [(0, 1, 0, 1)] + [(0.1 + 0.8 * (k % 2), 0.5, 0.1, 1) for k in range(count)]
    cone = [(0, 1.4, 0)] + ring
    leaf = model.material((0.9, 0.9, 0.9), 0, 0.8)
    colors = model.accessor([[round(255 * x) for x in shade] for shade in shades], U8, normalized=True)
    crown = model.primitive(cone, [0, *range(1, count + 1), 1], leaf, index_type=U8, mode=6, COLOR_0=colors)
    # A trunk of one strip, in quantised numbers.
    rows = [(round(32767 * 0.3 * x), 32767 * top, round(32767 * 0.3 * z)) for x, _, z in ring + ring[:1] for top in (1, 0)]
    model.use("KHR_mesh_quantization")
    model.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    trunk = model.primitive(model.accessor(rows, I16, normalized=True), None, model.material((0.35, 0.2, 0.1), 0, 1), mode=5)
    crown, trunk = model.mesh(crown), model.mesh(trunk)
    tree = model.node(False, mesh=trunk, children=[
        model.node(False, mesh=crown, translation=[0, 0.8, 0]),
        model.node(False, mesh=crown, translation=[0, 1.5, 0], scale=[0.7, 0.8, 0.7]),
    ])
    model.node(children=[tree], translation=[-2.6, 0, 0])
    copies = [([0, 0, 0.4], [1.2, 1.4, 1.2]), ([2.4, 0, -0.6], [-0.9, 1, 1.1]), ([4, 0, -2], [0.8, 1.8, 0.8])]
    for place, scale in copies:
        # A tree has one parent: copies of its nodes share their meshes.
        parts = [
            model.node(False, mesh=trunk),
            model.node(False, mesh=crown, translation=[0, 0.8, 0]),
            model.node(False, mesh=crown, translation=[0, 1.5, 0], scale=[0.7, 0.8, 0.7]),
        ]
        model.node(children=parts, translation=place, scale=scale, rotation=[0, 0.19509032, 0, 0.98078528])
    # A floor whose far corners are sparse.
    points, uvs, indices = quad(4)
    sparse = {2: (8, 0.5, -8), 3: (-8, 0.5, -8)}
    floor = model.primitive(model.accessor(points, sparse=sparse), indices, model.material((0.5, 0.55, 0.5), 0, 1))
    model.node(mesh=model.mesh(floor))
    model.camera([1, 3, 9], [0.4, 1.1, 0], 38)
    model.write(folder / "tree.gltf", "data")


def leaves(folder):
    model = Model()
    # Texels are large and not blended: a cut runs along their edges.
    leaf = lambda x, y: (40 + 8 * x, 150 - 5 * y, 30, 255 if (x - 9) ** 2 + (y - 6) ** 2 < 40 and x != 8 else 0)
    picture = {"index": model.texture(16, 16, leaf, magFilter=9728, minFilter=9728)}
    pbr = {"baseColorTexture": picture, "metallicFactor": 0, "roughnessFactor": 1}
    card = model.material(pbr=pbr, alphaMode="MASK", alphaCutoff=0.5)
    veil = model.material((0.9, 0.4, 0.3), 0, 1, alpha=0.35, alphaMode="BLEND")
    solid = model.material((0.3, 0.4, 0.8), 0, 1, alpha=0.1)
    points, uvs, indices = quad(1)
    upright = math.sqrt(0.5)
    for number in range(9):
        turn = 0.7 * number
        sin, cos = upright * math.sin(turn / 2), upright * math.cos(turn / 2)
        mesh = model.mesh(model.primitive(points, indices, card, uvs=uvs))
        model.node(mesh=mesh, translation=[1.6 * (number % 3) - 2.6, 1 + 0.2 * (number // 3), 1.5 * (number // 3) - 1.5], rotation=[cos, sin, -sin, cos])
    mesh = model.mesh(model.primitive(points, indices, veil, uvs=uvs))
    model.node(mesh=mesh, translation=[2.6, 1.2, 0.6], rotation=[upright, 0, 0, upright])
    model.node(mesh=model.mesh(model.ball() | {"material": solid}), translation=[2.7, 1, -1.5])
    points, uvs, indices = quad(6)
    model.node(mesh=model.mesh(model.primitive(points, indices, model.material((0.6, 0.6, 0.6), 0, 1))))
    model.camera([3, 5, 9], [0.2, 0.8, 0], height=5.5)
    model.write(folder / "leaves.glb", "glb")


def punctual(folder):
    model = Model()
    grey = model.material((0.6, 0.6, 0.6), 0, 1)
    points, uvs, indices = quad(6)
    model.node(mesh=model.mesh(model.primitive(points, indices, grey)))
    for x, z in [(-1.5, 0), (0.3, -0.8), (1.8, 0.5)]:
        model.node(mesh=model.mesh(model.ball() | {"material": model.material((0.7, 0.5, 0.4), 0, 0.6)}), translation=[x, 0.6, z], scale=[0.6, 0.6, 0.6])
    model.use("KHR_lights_punctual")
    # A hard edge: Blender softens others its own way.
    cone = {"innerConeAngle": 0.5999, "outerConeAngle": 0.6}
    model.json["extensions"] = {"KHR_lights_punctual": {"lights": [
        {"type": "point", "color": [1, 0.7, 0.4], "intensity": 6},
        {"type": "spot", "color": [0.4, 0.6, 1], "intensity": 40, "spot": cone},
        {"type": "directional", "color": [1, 1, 0.9], "intensity": 1.2},
    ]}}
    light = lambda number: {"KHR_lights_punctual": {"light": number}}
    model.node(translation=[-0.6, 2.2, 1.4], extensions=light(0))
    upright = math.sqrt(0.5)
    model.node(translation=[1.6, 4, 0.4], rotation=[-upright, 0, 0, upright], extensions=light(1))
    model.node(rotation=unit([-0.4, 0.3, 0.1, 0.8]), extensions=light(2))
    model.camera([0, 3.4, 7], [0, 0.4, 0], 38)
    model.write(folder / "punctual.gltf", "data")


def frosted(folder):
    model = Model()
    ball = model.ball()
    for x, roughness in [(-2.2, 0.1), (0, 0.2), (2.2, 0.3)]:
        extensions = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5}}
        extensions["KHR_materials_volume"] = {"thicknessFactor": 1}
        model.node(mesh=model.mesh(ball | {"material": model.material((1, 1, 1), 0, roughness, extensions=extensions)}), translation=[x, 1.01, 0])
    points, uvs, indices = quad(6)
    checker = lambda x, y: (220, 220, 220) if (x // 4 + y // 4) % 2 else (60, 60, 70)
    check = model.texture(64, 64, checker, magFilter=9728, minFilter=9728)
    pbr = {"baseColorTexture": {"index": check}, "metallicFactor": 0, "roughnessFactor": 1}
    model.node(mesh=model.mesh(model.primitive(points, indices, model.material(pbr=pbr), uvs=uvs)))
    model.camera([0, 2.2, 7.5], [0, 0.9, 0], 36)
    model.write(folder / "frosted.glb", "glb")


MODELS = {
    "grid.gltf": grid,
    "textured.glb": textured,
    "lamps.gltf": lamps,
    "glass.glb": glass,
    "thin.glb": thin,
    "tree.gltf": tree,
    "leaves.glb": leaves,
    "punctual.gltf": punctual,
    "frosted.glb": frosted,
}


def write_all(folder):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for make in MODELS.values():
        make(folder)
    return [folder / name for name in MODELS]


if __name__ == "__main__":
    print(*write_all(sys.argv[1]), sep="\n")
