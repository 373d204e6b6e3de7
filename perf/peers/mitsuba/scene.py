"""What a scene is, read from octray's own words: plain lists that another renderer can be told. Knows nothing of Mitsuba.

Defaults, camera and sky come from `octray inspect`, models from `octray convert`: only primitives and materials are read here.
"""

import json
import math
from pathlib import Path

FACTS = ["resolution", "max_bounces", "sky", "camera", "bounds"]
# What octray takes where a file is silent.
UNNAMED = {"type": "diffuse", "color": [0.8, 0.8, 0.8]}
COLORS = {"diffuse": [0.8, 0.8, 0.8], "metal": [1, 1, 1], "glass": [1, 1, 1], "emitter": [0, 0, 0]}


class Refused(Exception):
    """Why a scene cannot be compared."""


def load(octray, spec, root, scratch):
    """The scene as a dictionary: FACTS, and `materials`, `spheres` and `triangles` in the scene's order."""
    inspected = json.loads(octray.run("inspect", spec, "--json"))
    if inspected["sky"]["type"] not in ("color", "gradient"):
        raise Refused("its sky is a picture")
    path = file_of(octray, spec, root, scratch)
    file = json.loads(path.read_text(encoding="utf-8-sig"))
    if "format" not in file:
        raise Refused("it is in the thesis's format, whose materials scatter in ways Mitsuba does not have")

    scene = {fact: inspected[fact] for fact in FACTS}
    scene.update(materials={}, spheres=[], triangles=[])
    for name, written in file.get("materials", {}).items():
        scene["materials"][name] = written
    for sphere in file.get("spheres", []):
        name = worn(scene, sphere)
        scene["spheres"].append({"center": sphere["center"], "radius": sphere["radius"], "material": name})
    for triangle in file.get("triangles", []):
        scene["triangles"].append({"vertices": triangle["vertices"], "material": worn(scene, triangle)})
    for number, mesh in enumerate(file.get("meshes", [])):
        add_mesh(octray, scene, mesh, path.parent, scratch / f"mesh{number}.json")

    used = {thing["material"] for thing in scene["spheres"] + scene["triangles"]}
    scene["materials"] = {name: material(name, written) for name, written in scene["materials"].items() if name in used}
    # Octray counts them too: a translation that lost something ends here.
    for kind in ["spheres", "triangles"]:
        if len(scene[kind]) != inspected[kind]:
            raise Refused(f"octray finds {inspected[kind]} {kind} in it, and this script {len(scene[kind])} in {path.name}")
    return scene


def file_of(octray, spec, root, scratch):
    """The native file that says the same."""
    if spec.startswith("builtin:"):
        path = root / "scenes" / f"{spec.removeprefix('builtin:')}.json"
        if not path.is_file():
            raise Refused("it is made by rule inside octray, and no file says what it holds")
        return path
    if spec.lower().endswith(".obj"):
        path = scratch / "model.json"
        octray.run("convert", spec, path, "--force")
        return path
    return Path(spec)


def worn(scene, thing):
    """The name of a thing's material."""
    if thing.get("material") is None:
        scene["materials"][""] = UNNAMED
        return ""
    return thing["material"]


def material(name, written):
    """With all that octray would add, or refused."""
    kind, roughness = written["type"], written.get("roughness", 0)
    if written.get("texture"):
        raise Refused(f"its material `{name}` has a picture")
    if kind not in COLORS or (kind == "metal" and roughness > 0):
        rough = "rough " if roughness > 0 else ""
        raise Refused(f"its material `{name}` is {rough}{kind}: only diffuse, smooth metal, glass and emitter are translated")
    emission = written.get("emission", [1, 1, 1] if kind == "emitter" else [0, 0, 0])
    return {"type": kind, "color": written.get("color", COLORS[kind]), "ior": written.get("ior", 1.5), "emission": emission}


def add_mesh(octray, scene, mesh, folder, converted):
    """The triangles of a model where the scene has it: scaled, turned about x, y, z, and moved."""
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
