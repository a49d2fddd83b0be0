"""Packs the add-on with the Python package and the shared library into a zip that Blender installs: the
same bytes from the same files.

    python3 pack.py LIBRARY VERSION ZIP

LIBRARY is for the machine that packs it: its platform is what the zip is for. OBJCOPY, if set, is the
program that takes debug symbols out of a copy of it.

SPDX-License-Identifier: MIT
"""

import os
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
TOP = HERE.parent.parent.parent
ADDON = "starcontour_checks"


def platform_name():
    """The name of this platform as Blender's manifests have it."""
    system = {"linux": "linux", "darwin": "macos", "win32": "windows"}.get(sys.platform, sys.platform)
    machine = platform.machine().lower()
    return f"{system}-{ {'x86_64': 'x64', 'amd64': 'x64', 'aarch64': 'arm64'}.get(machine, machine)}"


def stripped(library):
    """The bytes of a library, without debug symbols if that can be had."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "library"
        shutil.copyfile(library, copy)
        program = os.environ.get("OBJCOPY")
        if program and shutil.which(program):
            subprocess.run([program, "--strip-unneeded", str(copy)], check=False, capture_output=True)
        return copy.read_bytes()


def files(library, version):
    """Names in the zip, and what is in them."""
    numbers = ", ".join(version.split("."))
    for path in sorted((HERE / ADDON).iterdir()):
        if path.suffix not in (".py", ".toml"):
            continue
        text = path.read_text()
        if path.name == "blender_manifest.toml":
            text = text.replace("@VERSION@", version).replace("@PLATFORM@", platform_name())
        elif path.name == "__init__.py":
            text = text.replace('"version": (0, 1, 0)', f'"version": ({numbers})')
        yield path.name, text.encode()
    for path in sorted((TOP / "tools/python/starcontour").iterdir()):
        if path.suffix == ".py" and path.name != "batch.py":
            yield f"starcontour/{path.name}", path.read_bytes()
    suffix = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
    yield f"starcontour/libstarcontour{suffix}", stripped(library)
    yield "LICENSE", (TOP / "LICENSE").read_bytes()


def main():
    library, version, target = sys.argv[1:]
    Path(target).parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(target + ".part", "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files(library, version):
            entry = zipfile.ZipInfo(f"{ADDON}/{name}", (1980, 1, 1, 0, 0, 0))
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, data)
    os.replace(target + ".part", target)
    print(target)


if __name__ == "__main__":
    main()
