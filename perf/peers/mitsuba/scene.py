"""Reads a scene as octray does, into plain lists that any renderer can use. Must not depend on Mitsuba.

Defaults, camera and sky come from `octray inspect`, models from `octray convert`: only primitives and
materials are read here.
"""

import json
import math
from pathlib import Path

FACTS = ["resolution", "max_bounces", "sky", "camera", "bounds"]
# octray's defaults.
UNNAMED = {"type": "diffuse", "color": [0.8, 0.8, 0.8]}
COLORS = {"diffuse": [0.8, 0.8, 0.8], "metal": [1, 1, 1], "glass": [1, 1, 1], "emitter": [0, 0, 0]}


class Refused(Exception):
    """Why a scene cannot be compared."""


def load(octray, spec, root, scratch):
    """The scene as a dictionary: FACTS, and `materials`, `spheres` and `triangles` in the scene's order."""
    inspected = json.loads(octray.run("inspect", spec, "--json"))
    if inspected["sky"]["type"] not in ("color", "gradient"):
        raise Refused("its sky has a texture")
    path = file_of(octray, spec, root, scratch)
    file = json.loads(path.read_text(encoding="utf-8-sig"))
    if "format" not in file:
        raise Refused("it is in the thesis's format, whose materials scatter in ways Mitsuba does not have")

    scene = {fact: inspected[fact] for fact in FACTS}
    scene.update(materials={}, spheres=[], triangles=[])
    for name, written in file.get("materials", {}).items():
        scene["materials"][name] = written
    for sphere in file.get("spheres", []):
        name = material_name(scene, sphere)
        scene["spheres"].append({"center": sphere["center"], "radius": sphere["radius"], "material": name})
    for triangle in file.get("triangles", []):
        scene["triangles"].append({"vertices": triangle["vertices"], "material": material_name(scene, triangle)})
    for number, mesh in enumerate(file.get("meshes", [])):
        add_mesh(octray, scene, mesh, path.parent, scratch / f"mesh{number}.json")

    used = {thing["material"] for thing in scene["spheres"] + scene["triangles"]}
    scene["materials"] = {name: material(name, written) for name, written in scene["materials"].items() if name in used}
    # octray's counts reveal a translation that lost something.
    for kind in ["spheres", "triangles"]:
        if len(scene[kind]) != inspected[kind]:
            raise Refused(f"octray finds {inspected[kind]} {kind} in it, and this script {len(scene[kind])} in {path.name}")
    return scene


def file_of(octray, spec, root, scratch):
    """The scene file in the native format."""
    if spec.startswith("builtin:"):
        path = root / "scenes" / f"{spec.removeprefix('builtin:')}.json"
        if not path.is_file():
            raise Refused("it is procedural, so there is no file to read")
        return path
    if spec.lower().endswith(".obj"):
        path = scratch / "model.json"
        octray.run("convert", spec, path, "--force")
        return path
    return Path(spec)


def material_name(scene, thing):
    """The name of the material of a primitive."""
    if thing.get("material") is None:
        scene["materials"][""] = UNNAMED
        return ""
    return thing["material"]


def material(name, written):
    """With octray's defaults filled in, or refused."""
    kind, roughness = written["type"], written.get("roughness", 0)
    if written.get("texture"):
        raise Refused(f"its material `{name}` has a texture")
    if kind not in COLORS or (kind == "metal" and roughness > 0):
        rough = "rough " if roughness > 0 else ""
        raise Refused(f"its material `{name}` is {rough}{kind}: only diffuse, smooth metal, glass and emitter are translated")
    emission = written.get("emission", [1, 1, 1] if kind == "emitter" else [0, 0, 0])
    return {"type": kind, "color": written.get("color", COLORS[kind]), "ior": written.get("ior", 1.5), "emission": emission}


def add_mesh(octray, scene, mesh, folder, converted):
    """The triangles of a model as the scene places it: scaled, rotated about x, y, z, and translated."""
    octray.run("convert", folder / mesh["obj"], converted, "--force")
    model = json.loads(converted.read_text())
    scale, move = mesh.get("scale", 1), mesh.get("translate", [0, 0, 0])
    turns = [math.radians(degrees) for degrees in mesh.get("rotate_degrees", [0, 0, 0])]

    def placed(point):
        point = [scale * x for x in point]
        for axis, turn in enumerate(turns):
            i, j = (axis + 1) % 3, (axis + 2) % 3
            a, b = point[i], point[j]
            point[i], point[j] = a * math.cos(turn) - b * math.sin(turn), a * math.sin(turn) + b * math.cos(turn)
        return [x + shift for x, shift in zip(point, move)]

    for triangle in model["triangles"]:
        name = mesh.get("material")
        if name is None:
            name = f"{converted.stem} {triangle['material']}"
            scene["materials"][name] = model["materials"][triangle["material"]]
        scene["triangles"].append({"vertices": [placed(v) for v in triangle["vertices"]], "material": name})
