"""What a frame's instructions need at best, beside the time that it takes: figures and tables."""

import collections
import statistics

from instructions import CLASS_OF, CLASSES, FUSES, VECTOR_CLASSES, kinds, operations, split

# Stages by the source file of the outermost inlined function that has one of these names in it.
STAGES = [
    ("integrate/generate.rs", "generate"),
    ("integrate/intersect.rs", "intersect"),
    ("integrate/shade.rs", "shade, finish"),
    ("integrate/shadow_rays.rs", "shadow rays"),
    ("traverse/", "trace"),
    # Radiance is added in both stages.
    ("integrate/scratch.rs", "shade, finish"),
    ("film/", "film"),
    ("src/engine/", "rest of the engine"),
]
PACKAGES = ("/src/engine/", "/src/rays/")
# Not the caller's own work: what it computes with.
TOOLS = ("lane/", "math/")


def stage(origin):
    """The stage of an instruction by its chain of inlined functions; None outside the engine."""
    for _, file in origin:
        for part, name in STAGES[:-1]:
            if part in file:
                return name
    return STAGES[-1][1] if any(STAGES[-1][0] in file for _, file in origin) else None


def source(origin):
    """The file of the innermost function in the engine or the rays that is not a lane type or vector arithmetic."""
    ours = [file.partition("/src/")[2] for _, file in origin if any(part in file for part in PACKAGES)]
    own = [file for file in ours if not file.partition("/")[2].startswith(TOOLS)]
    return (own or ours or ["?"])[-1]


def summarise(rows, processor, rays):
    """Counts a ray of some instructions, and what the processor needs for them at best."""
    classes, needed, events = collections.Counter(), collections.Counter(), collections.Counter()
    instructions = slots = flops = 0
    for row in rows:
        name, operands = split(row.text)
        found = kinds(name, operands)
        instructions += row.executed
        flops += row.executed * operations(name, operands)
        events.update(row.events)
        # The class of what it computes; of its access to memory if it computes nothing.
        classes[CLASS_OF[found[0] if found else "move"]] += row.executed
        # Loads and stores within other instructions.
        for kind in found[1:]:
            if CLASS_OF[kind] in ("load", "store") and CLASS_OF[found[0]] not in ("load", "store"):
                classes["memory operands"] += row.executed
        for kind in found:
            needed[kind] += row.executed
        # A comparison and the jump after it are one micro-operation.
        if name.startswith("j") and name != "jmp" and FUSES.fullmatch(split(row.previous)[0]):
            needed["scalar"] -= row.executed
        else:
            slots += row.executed * processor.slots(found)
    cycles, decides = processor.bound(needed, slots)
    vector = sum(classes[name] for name in VECTOR_CLASSES)
    return {
        "instructions": instructions / rays,
        "vector": vector / rays,
        "flops": flops / rays,
        "classes": {name: classes[name] / rays for name in [*CLASSES, "memory operands"]},
        "occupied": {name: busy / rays for name, busy in processor.occupied(needed, slots)},
        "bound": cycles / rays,
        "decides": decides,
        "mispredicted": (events["Bcm"] + events["Bim"]) / rays,
        "l1_misses": (events["D1mr"] + events["D1mw"]) / rays,
        "l2_misses": (events["DLmr"] + events["DLmw"]) / rays,
    }


def spread(values):
    return {"median": statistics.median(values), "min": min(values), "max": max(values)}


def result(rows, rays, processor, measured, options):
    """The whole report. `measured`: rounds of timing, the stages' shares of time, counters; each may be empty."""
    engine = [row for row in rows if stage(row.origin)]
    whole = summarise(engine, processor, rays)
    groups = collections.defaultdict(list)
    for row in engine:
        groups[stage(row.origin)].append(row)
    shares = measured["shares"]
    time = {name: sum(shares.get(part, 0) for part in name.split(", ")) for name in groups}
    stages = [{"stage": name, **summarise(groups[name], processor, rays), "time": time[name]} for name in groups]
    files = collections.Counter()
    for row in engine:
        files[source(row.origin)] += row.executed
    return {
        "schema": "octray-limit-1",
        "scene": options.scene,
        "size": options.size,
        "bounces": options.bounces,
        "lanes": options.lanes,
        "processor": processor.name,
        "rays_per_frame": rays,
        "outside_the_engine": 1 - sum(row.executed for row in engine) / sum(row.executed for row in rows),
        **whole,
        "stages_bound": sum(entry["bound"] for entry in stages),
        "stages": sorted(stages, key=lambda entry: -entry["instructions"]),
        "files": [{"file": file, "instructions": count / rays} for file, count in files.most_common(options.files)],
        "counters": measured["counters"],
        **(timing(measured["rounds"], rays, whole["bound"], options) if measured["rounds"] else {"cycles": None}),
    }


def timing(rounds, rays, bound, options):
    """Ratios of each round, where clock and frames were measured in turns."""
    def cycles(entry, fps):
        return entry["clock_ghz"] * 1e9 / (fps * rays)

    first = [entry["threads"][1] for entry in rounds]
    threads = []
    for number in sorted(rounds[0]["threads"]):
        here = [entry["threads"][number] for entry in rounds]
        frames = [now["fps"] / one["fps"] for now, one in zip(here, first)]
        loop = [now["loop"] / one["loop"] for now, one in zip(here, first)]
        threads.append({
            "threads": number,
            "fps": spread([now["fps"] for now in here]),
            "frames": spread(frames),
            "loop": spread(loop),
            "ratio": spread([a / b for a, b in zip(frames, loop)]),
        })
    found = {
        "clock_ghz": spread([entry["clock_ghz"] for entry in rounds]),
        "cycles": spread([cycles(entry, entry["threads"][1]["fps"]) for entry in rounds]),
        "bound_fps": spread([entry["clock_ghz"] * 1e9 / (bound * rays) for entry in rounds]),
        "of_bound": spread([bound / cycles(entry, entry["threads"][1]["fps"]) for entry in rounds]),
        "threads": threads,
    }
    if options.beside:
        found["beside"] = spread([entry["beside"] / entry["threads"][1]["fps"] for entry in rounds])
    return found


def text(found):
    size = f"{found['size']}, up to {found['bounces']} bounces, {found['lanes']} lanes, built for x86-64-v3"
    lines = [
        f"{found['scene']}, {size}",
        f"{found['rays_per_frame']:,.0f} rays a frame; a ray: {found['instructions']:.1f} instructions, of which "
        f"{found['vector']:.1f} vector operations; {found['flops']:.0f} operations on floats",
        "",
        f"{'instructions':<22}{'a ray':>8}{'share':>8}",
    ]
    for name, count in found["classes"].items():
        if count:
            share = "" if name == "memory operands" else f"{count / found['instructions']:.1%}"
            lines.append(f"{name:<22}{count:>8.2f}{share:>8}")
    lines += ["", f"{'busy at least':<22}{'cycles':>8}   a ray, {found['processor']}"]
    lines += [f"{name:<22}{cycles:>8.2f}" for name, cycles in found["occupied"].items()]
    lines += [f"{'bound':<22}{found['bound']:>8.2f}   {found['decides']}"]
    lines += [f"{'one after another':<22}{found['stages_bound']:>8.2f}   the sum of the stages' bounds", ""]
    lines += stage_table(found)
    if found["cycles"]:
        lines += measured(found)
    for name, counted in found["counters"].items():
        cycles, instructions = counted["cycles"], counted["instructions"]
        lines.append(
            f"counters, {name + ':':<16} {instructions:.1f} instructions and {cycles:.1f} cycles a ray, "
            f"{instructions / cycles:.2f} a cycle; the bound is {found['bound'] / cycles:.0%} of these cycles"
        )
    if found["files"]:
        lines += ["", f"{'source file':<36}{'a ray':>8}{'share':>8}"]
        for entry in found["files"]:
            share = entry["instructions"] / found["instructions"]
            lines.append(f"{entry['file']:<36}{entry['instructions']:>8.2f}{share:>8.1%}")
    return "\n".join(lines)


def stage_table(found):
    columns = ["instructions", "vector", "bound", "cycles", "of bound", "mispredicted", "L1 misses"]
    lines = [f"{'stage, a ray':<22}" + "".join(f"{name:>13}" for name in columns)]
    for entry in [*found["stages"], {"stage": "all", "time": 1, **found}]:
        cycles = entry["time"] * found["cycles"]["median"] if entry["time"] and found["cycles"] else None
        cells = [f"{entry['instructions']:.2f}", f"{entry['vector']:.2f}", f"{entry['bound']:.2f}"]
        cells += [f"{cycles:.2f}", f"{entry['bound'] / cycles:.0%}"] if cycles else ["", ""]
        cells += [f"{entry['mispredicted']:.3f}", f"{entry['l1_misses']:.3f}"]
        lines.append(f"{entry['stage']:<22}" + "".join(f"{cell:>13}" for cell in cells))
    return lines


def measured(found):
    def wide(value, form="{:.2f}"):
        ends = f" ({form}-{form})".format(value["min"], value["max"])
        return form.format(value["median"]) + ends

    fps = found["threads"][0]["fps"]
    cycles = found["cycles"]["median"]
    lines = [
        "",
        f"clock                 {wide(found['clock_ghz'])} GHz, by sums that wait for each other",
        f"at best               {wide(found['bound_fps'], '{:,.0f}')} frames per second, {found['bound']:.2f} cycles a ray",
        f"measured              {wide(fps, '{:,.0f}')} frames per second, {wide(found['cycles'], '{:.1f}')} cycles a ray, "
        f"{found['instructions'] / cycles:.2f} instructions a cycle",
        f"of the bound          {wide(found['of_bound'], '{:.0%}')}",
    ]
    if "beside" in found:
        lines.append(f"the other program     {wide(found['beside'])} times as fast")
    lines += ["", f"{'threads':<9}{'frames per second':<25}{'to one':<20}{'loop to one':<20}{'frames to loop':<20}"]
    for entry in found["threads"]:
        cells = f"{wide(entry['frames']):<20}{wide(entry['loop']):<20}{wide(entry['ratio']):<20}"
        lines.append(f"{entry['threads']:<9}{wide(entry['fps'], '{:,.0f}'):<25}" + cells.rstrip())
    return lines
