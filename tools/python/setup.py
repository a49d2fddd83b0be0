"""Builds the wheel: compiles the files of lib/sources.list to a shared library inside the package.

The package needs no extension module: it loads that library by ctypes, so one wheel serves every
version of Python 3 on its platform. In the repository the sources are two folders up; a source
distribution carries a copy of them in core/. Everything built goes to a temporary folder.

SPDX-License-Identifier: MIT
"""

import atexit
import re
import shutil
import sys
import tempfile
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

# Newer versions of Python have distutils only through setuptools, which comes first therefore.
from distutils.ccompiler import new_compiler
from distutils.sysconfig import customize_compiler

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:
    from wheel.bdist_wheel import bdist_wheel

HERE = Path(__file__).resolve().parent
ROOT = HERE / "core" if (HERE / "core").is_dir() else HERE.parent.parent
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def sources():
    lines = (ROOT / "lib/sources.list").read_text().splitlines()
    return [line for line in (line.split("#")[0].strip() for line in lines) if line]


def version():
    header = (ROOT / "include/starcontour.h").read_text()
    return ".".join(
        re.search(rf"^#define SC_VERSION_{part} (\d+)$", header, re.MULTILINE).group(1)
        for part in ("MAJOR", "MINOR", "PATCH")
    )


def scratch(name):
    """A folder that goes when setup.py does."""
    folder = tempfile.mkdtemp(prefix=f"starcontour-{name}-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def compile_library(output, objects):
    compiler = new_compiler()
    customize_compiler(compiler)
    macros = [("NDEBUG", None)]
    if compiler.compiler_type == "msvc":
        options, libraries = ["/O2", "/fp:precise"], []
        macros += [("SC_SHARED", None), ("SC_BUILDING", None)]
    else:
        # After the options that Python was built with, so that these are the last word.
        options = ["-std=c99", "-O3", "-fPIC", "-fvisibility=hidden", "-ffp-contract=off",
                   "-fno-fast-math"]
        libraries = ["m"]
        if sys.platform == "win32":
            macros += [("SC_SHARED", None), ("SC_BUILDING", None)]
    compiled = []
    for source in sources():
        # One by one, so that object files keep their folders wherever the sources are.
        compiled += compiler.compile(
            [str(ROOT / source)], output_dir=str(Path(objects) / Path(source).parent.name),
            macros=macros, include_dirs=[str(ROOT / "include"), str(ROOT / "lib")],
            extra_postargs=options)
    compiler.link_shared_object(compiled, str(output), libraries=libraries)


class Package(build_py):
    """The Python files, and beside them the library and its licence."""

    def run(self):
        super().run()
        if getattr(self, "editable_mode", False):
            raise SystemExit("starcontour: no editable installation; use PYTHONPATH=tools/python "
                             "with STARCONTOUR_LIBRARY=build/lib/libstarcontour.so")
        folder = Path(self.build_lib) / "starcontour"
        folder.mkdir(parents=True, exist_ok=True)
        compile_library(folder / f"libstarcontour{SUFFIX}", scratch("objects"))
        shutil.copyfile(ROOT / "LICENSE", folder / "LICENSE")


class Wheel(bdist_wheel):
    """For every Python 3, on this platform."""

    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


class Sources(sdist):
    """What is needed to build the wheel without the repository."""

    def make_release_tree(self, base_dir, files):
        super().make_release_tree(base_dir, files)
        core = Path(base_dir) / "core"
        for folder, pattern in (("lib", "*.c"), ("lib", "*.h"), ("include", "*.h")):
            for path in (ROOT / folder).rglob(pattern):
                target = core / path.relative_to(ROOT)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, target)
        for path in ("lib/sources.list", "LICENSE"):
            shutil.copyfile(ROOT / path, core / path)


class WithLibrary(Distribution):
    def has_ext_modules(self):
        return True


setup(
    version=version(),
    packages=["starcontour"],
    package_data={"starcontour": ["py.typed", "*.pyi"]},
    distclass=WithLibrary,
    cmdclass={"build_py": Package, "bdist_wheel": Wheel, "sdist": Sources},
    options={
        "build": {"build_base": scratch("build")},
        "egg_info": {"egg_base": scratch("egg")},
    },
)
