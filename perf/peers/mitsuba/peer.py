"""Renders the scene of scene.py with Mitsuba 3: a program of its own, so that threads are set before the
first kernel.

    peer.py JOB.json      job: scene, size, variant, sampler, folder

Prints one line of JSON when ready, then one for each line {"samples", "seed", "output"} of its input: the
seconds of rendering. The picture is written to `output` (NumPy, linear RGB). Uses as many threads as it has
cores.
"""

import json
import os
import sys
import time

import mitsuba as mi
import numpy as np

# Rays that Mitsuba may keep in memory at once.
WAVEFRONT = 1 << 24
# Rows of the environment map of a gradient; linear interpolation errs by (π / rows)² / 8 of the gradient's
# range.
SKY_ROWS = 2049
# Distance of the two one-sided lights that make a two-sided one, in diagonals of the scene: beyond rounding
# in single precision.
GAP = 1e-5


def rgb(value):
    return {"type": "rgb", "value": [float(x) for x in value]}


def bsdf(material):
    """octray's surfaces scatter alike on both sides, except glass."""
    kind, color = material["type"], rgb(material["color"])
    if kind == "glass":
        tints = {"specular_reflectance": color, "specular_transmittance": color}
        return {"type": "dielectric", "int_ior": float(material["ior"]), "ext_ior": 1.0, **tints}
    if kind == "metal":
        # No metal in particular: the same reflectance at every angle.
        return {"type": "twosided", "side": {"type": "conductor", "material": "none", "specular_reflectance": color}}
    # An emitter is black under its light.
    return {"type": "twosided", "side": {"type": "diffuse", "reflectance": color}}


def emits(material):
    return any(material["emission"])


class Lights:
    """octray's lights emit on both sides, Mitsuba's `area` on one."""

    def __init__(self, scene):
        self.gap = GAP * float(np.linalg.norm(np.subtract(scene["bounds"]["upper"], scene["bounds"]["lower"])))

    def shapes(self, name, material, shape):
        """The shapes, by name, that make `shape(inset, flipped)` emit on both sides."""
        if not emits(material):
            return {name: shape(0, False)}
        emission = rgb(material["emission"])
        if mi.variant().startswith("scalar"):
            # Python is too slow for single rays: two shapes back to back. Not for glass, whose faces would
            # count twice.
            sides = {name: shape(0, False), f"{name} back": shape(self.gap, True)}
            return {side: {**it, "light": {"type": "area", "radiance": emission}} for side, it in sides.items()}
        # Named, because the loader merges equal lights, and a light belongs to one shape.
        return {name: {**shape(0, False), "light": {"type": "two_faced_area", "radiance": emission, "shape": name}}}


def register_two_faced_area():
    """Mitsuba's `area` without the test of the side; points and pdfs are those of the shape."""
    import drjit as dr

    class TwoFacedArea(mi.Emitter):
        def __init__(self, props):
            super().__init__(props)
            self.radiance = mi.Color3f(props["radiance"])
            self.shape_name = props["shape"]
            self.m_flags = mi.EmitterFlags.Surface

        def eval(self, si, active=True):
            return dr.select(active, self.radiance, 0)

        def sample_direction(self, it, sample, active=True):
            found = self.get_shape().sample_direction(it, sample, active)
            active &= found.pdf > 0
            found.emitter = mi.EmitterPtr(self)
            return found, dr.select(active, self.radiance / found.pdf, 0)

        def pdf_direction(self, it, ds, active=True):
            return dr.select(active, self.get_shape().pdf_direction(it, ds, active), 0)

        def eval_direction(self, it, ds, active=True):
            return dr.select(active, self.radiance, 0)

        def to_string(self):
            return f"TwoFacedArea[{self.shape_name}, {self.radiance}]"

    mi.register_emitter("two_faced_area", TwoFacedArea)


def sphere(it, material):
    def shape(inset, flipped):
        return {
            "type": "sphere", "center": it["center"], "radius": it["radius"] - inset, "flip_normals": flipped, "bsdf": bsdf(material)
        }

    return shape


def mesh(corners, material, path):
    """`corners`: of each triangle three points."""

    def shape(inset, flipped):
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        normals = np.cross(b - a, c - a)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        moved = corners - inset * normals[:, None]
        file = f"{path}{'-back' if flipped else ''}.ply"
        write_ply(moved[:, ::-1] if flipped else moved, file)
        return {"type": "ply", "filename": file, "face_normals": True, "bsdf": bsdf(material)}

    return shape


def write_ply(corners, file):
    made = mi.Mesh("mesh", 3 * len(corners), len(corners))
    values = mi.traverse(made)
    values["vertex_positions"] = np.ascontiguousarray(corners, dtype=np.float32).ravel()
    values["faces"] = np.arange(3 * len(corners), dtype=np.uint32)
    values.update()
    made.write_ply(file)


def sky(scene):
    """None if black: a black light would take its share of the light samples."""
    given = scene["sky"]
    if given["type"] == "color":
        return {"type": "constant", "radiance": rgb(given["color"])} if any(given["color"]) else None
    # From the zenith down; each row one colour, octray's blend by the height of the direction.
    height = np.cos(np.linspace(0, np.pi, SKY_ROWS))[:, None, None] / 2 + 0.5
    bottom, top = np.array(given["bottom"]), np.array(given["top"])
    rows = np.broadcast_to(bottom + (top - bottom) * height, (SKY_ROWS, 4, 3))
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(rows, dtype=np.float32))}


def translate(job):
    scene, (width, height) = job["scene"], job["size"]
    eye, target = np.array(scene["camera"]["position"]), np.array(scene["camera"]["look_at"])
    distance = float(np.linalg.norm(target - eye))
    view = mi.ScalarTransform4f().look_at(origin=eye.tolist(), target=target.tolist(), up=scene["camera"]["up"])
    world = {
        "type": "scene",
        # octray counts bounces, Mitsuba segments; octray has no Russian roulette.
        "integrator": {"type": "path", "max_depth": scene["max_bounces"] + 1, "rr_depth": 1 << 30, "hide_emitters": False},
        "sensor": {
            "type": "perspective", "fov": scene["camera"]["vertical_fov"], "fov_axis": "y", "to_world": view,
            "near_clip": 1e-4 * distance, "far_clip": 1e6 * distance,
            "film": {
                "type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"},
                "pixel_format": "rgb", "component_format": "float32",
            },
            "sampler": {"type": job["sampler"]},
        },
    }
    lights = Lights(scene)
    if (above := sky(scene)) is not None:
        world["sky"] = above
    for number, it in enumerate(scene["spheres"]):
        material = scene["materials"][it["material"]]
        world.update(lights.shapes(f"sphere{number}", material, sphere(it, material)))
    # One mesh per material: Mitsuba samples lights uniformly, however small they are.
    for number, (name, material) in enumerate(scene["materials"].items()):
        corners = np.array([it["vertices"] for it in scene["triangles"] if it["material"] == name], dtype=np.float32)
        if len(corners):
            path = os.path.join(job["folder"], f"mesh{number}")
            world.update(lights.shapes(f"mesh{number}", material, mesh(corners, material, path)))
    return mi.load_dict(world)


class Renderer:
    def __init__(self, job):
        self.world = translate(job)
        self.pixels = job["size"][0] * job["size"][1]
        self.jit = not job["variant"].startswith("scalar")

    def picture(self, samples, seed):
        """The mean of as many passes as fit into memory, and the seconds they took."""
        passes = max(1, -(-samples * self.pixels // WAVEFRONT))
        while samples % passes:
            passes += 1
        total, begun = 0, time.perf_counter()
        for number in range(passes):
            image = mi.render(self.world, spp=samples // passes, seed=seed * 4096 + number)
            if self.jit:
                import drjit as dr

                dr.eval(image)
                dr.sync_thread()
            total = total + np.array(image, dtype=np.float64)
        seconds = time.perf_counter() - begun
        had = self.world.sensors()[0].sampler().sample_count()
        if had != samples // passes:
            raise ValueError(f"the sampler takes {had} samples instead of {samples // passes}: ask for a power of 4")
        return total / passes, seconds


def main():
    # Output of the renderer goes to stderr: stdout is for answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)

    def answer(**values):
        print(json.dumps(values), file=answers, flush=True)

    with open(sys.argv[1]) as file:
        job = json.load(file)
    mi.set_variant(job["variant"])
    mi.set_log_level(mi.LogLevel.Warn)
    if not job["variant"].startswith("scalar"):
        register_two_faced_area()
    try:
        renderer = Renderer(job)
        answer(version=mi.__version__)
        for line in sys.stdin:
            request = json.loads(line)
            picture, seconds = renderer.picture(request["samples"], request["seed"])
            np.save(request["output"], picture)
            answer(seconds=seconds)
    except ValueError as error:
        answer(error=str(error))


if __name__ == "__main__":
    main()
