"""Installs Mitsuba and LLVM below target/tools the first time."""

import glob
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
TOOLS = ROOT / "target" / "tools"
# Mitsuba compiles with LLVM; older versions lack instructions that it needs (llvm.minimum on x86).
OLDEST_LLVM, DEBIAN_LLVM = 17, "libllvm19"


def say(text):
    print(text, file=sys.stderr, flush=True)


def skip(reason):
    say(f"SKIPPED: {reason}; nothing was measured.")
    sys.exit(0)


def enter():
    """Continues in a Python environment that has Mitsuba; the first time, creates it."""
    home = TOOLS / "mitsuba"
    python = home / "bin" / "python"
    if Path(sys.prefix).resolve() == home.resolve():
        return
    ready = home / "ready"
    if not ready.is_file():
        say(f"Installing Mitsuba 3, NumPy and SciPy (about 150 MB) below {home.relative_to(ROOT)}, this once.")
        packages = ["mitsuba>=3.7,<4", "numpy>=2", "scipy>=1.11"]
        steps = [[sys.executable, "-m", "venv", home], [python, "-m", "pip", "install", "--quiet", *packages]]
        for step in steps:
            try:
                done = subprocess.run([str(word) for word in step], stdout=subprocess.DEVNULL).returncode
            except OSError:
                done = 1
            if done:
                skip("Mitsuba cannot be installed: Python's venv and pip, and a network, are needed")
        ready.touch()
    os.execv(python, [str(python), *sys.argv])


def find_llvm():
    """Finds the library for Mitsuba's llvm variants: the system's if it is new enough, else Debian's
    package, unpacked.
    """
    if os.environ.get("DRJIT_LIBLLVM_PATH"):
        return
    own = TOOLS / "llvm"

    def version(path):
        found = re.search(r"libLLVM[-.](?:so\.)?(\d+)", path)
        return int(found[1]) if found else 0

    def newest():
        patterns = ["/usr/lib*/libLLVM*.so*", "/usr/lib/*/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*", f"{own}/usr/lib/*/libLLVM*.so*"]
        found = [path for pattern in patterns for path in glob.glob(pattern) if version(path) >= OLDEST_LLVM]
        return max(found, key=version, default=None)

    if not newest() and shutil.which("apt-get") and shutil.which("dpkg"):
        say(f"Unpacking Debian's {DEBIAN_LLVM} (about 130 MB) below {own.relative_to(ROOT)}, this once.")
        own.mkdir(parents=True, exist_ok=True)
        subprocess.run(["apt-get", "download", "--quiet", DEBIAN_LLVM], cwd=own, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for package in own.glob("*.deb"):
            subprocess.run(["dpkg", "-x", package, own], stdout=subprocess.DEVNULL)
            package.unlink()
    library = newest()
    if not library:
        skip(f"the variant needs LLVM {OLDEST_LLVM} or newer (Debian 12: apt install {DEBIAN_LLVM}, or name the library in DRJIT_LIBLLVM_PATH)")
    os.environ["DRJIT_LIBLLVM_PATH"] = library
