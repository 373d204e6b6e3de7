"""Finds Embree 3 on the system, installs Embree 4 below target/tools the first time, and compiles peer.cpp for
each.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
# PyPI's wheel with the library of Embree 4.4.0. The version is exact because embree4.h holds its layouts.
EMBREE_4 = "embreex==4.4.0.post1"


def say(text):
    print(text, file=sys.stderr, flush=True)


def skip(reason):
    say(f"SKIPPED: {reason}; nothing was measured.")
    sys.exit(0)


def fail(text):
    say(f"compare: {text}")
    sys.exit(2)


def run(command, core=None, allowed=(0,)):
    """What the command prints; pinned to one core if one is given."""
    pin = (lambda: os.sched_setaffinity(0, {core})) if core is not None else None
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, preexec_fn=pin, text=True)
    if done.returncode not in allowed:
        fail(f"{Path(command[0]).name} {' '.join(map(str, command[1:]))} ended with {done.returncode}")
    return done.stdout


def succeeds(command):
    try:
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.run([str(word) for word in command], **quiet).returncode == 0
    except OSError:
        return False


def find_embree3(compiler, scratch):
    """The linker's words for Embree 3, or None and the reason."""
    probe = scratch / "probe.cpp"
    probe.write_text("#include <embree3/rtcore.h>\nint main() { rtcReleaseDevice(rtcNewDevice(nullptr)); }\n")
    words = ["-lembree3"]
    if succeeds([compiler, "-std=c++17", "-o", scratch / "probe", probe, *words]):
        return words, None
    return None, "it is not installed (Debian 12: apt install libembree-dev)"


def find_embree4():
    """The linker's words for Embree 4, or None and the reason; the first time, installs it."""
    home = ROOT / "target" / "tools" / "embree4"
    ready = home / "ready"
    if not ready.is_file() or ready.read_text() != EMBREE_4:
        say(f"Installing {EMBREE_4} (about 50 MB) below {home.relative_to(ROOT)}, this once.")
        install = [home / "bin" / "python", "-m", "pip", "install", "--quiet", "--no-deps", "--only-binary=:all:", EMBREE_4]
        if not (succeeds([sys.executable, "-m", "venv", home]) and succeeds(install)):
            return None, f"{EMBREE_4} cannot be installed: Python's venv and pip, a network, and a wheel for this system are needed"
        ready.write_text(EMBREE_4)
    libraries = list(home.glob("lib*/python*/site-packages/embreex.libs/libembree4*"))
    if not libraries:
        return None, f"{EMBREE_4} brings no library for this system"
    return [libraries[0], f"-Wl,-rpath,{libraries[0].parent}"], None


def compile_peers(scratch):
    """The Embree programs that can be had, by name; ends this one if there is none."""
    compiler = os.environ.get("CXX", "c++")
    if not shutil.which(compiler):
        skip(f"there is no C++ compiler {compiler} (Debian 12: apt install g++)")
    peers, reasons = {}, []
    for version, find in [(3, lambda: find_embree3(compiler, scratch)), (4, find_embree4)]:
        words, reason = find()
        if reason:
            reasons.append(f"Embree {version}: {reason}")
            continue
        peer = peers[f"embree{version}"] = scratch / f"peer{version}"
        # Embree's kernels are in its library: these flags are for the loops that call them.
        flags = ["-std=c++17", "-O3", "-march=native", f"-DEMBREE={version}"]
        run([compiler, *flags, "-o", peer, HERE / "peer.cpp", *words])
    if not peers:
        skip("; ".join(reasons))
    for reason in reasons:
        say(f"SKIPPED: {reason}.")
    return peers
