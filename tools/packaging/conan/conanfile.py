"""A Conan 2 recipe that builds starcontour from the checkout or archive it lies in.

    conan create tools/packaging/conan            from the top of the repository

An example of a recipe, tested by tests/packages/conan.sh where there is Conan. One for an index would
fetch a released archive in source() instead of taking the files along.

SPDX-License-Identifier: MIT
"""

import os
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load


class Starcontour(ConanFile):
    name = "starcontour"
    description = "Every self-collision of a deforming triangle mesh, exactly"
    license = "MIT"
    topics = ("collision-detection", "geometry", "simulation", "mesh")
    package_type = "library"
    languages = "C"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False]}
    default_options = {"shared": False, "fPIC": True}
    implements = ["auto_shared_fpic"]

    @property
    def top(self):
        return os.path.join(self.recipe_folder, "..", "..", "..")

    def set_version(self):
        header = load(self, os.path.join(self.top, "include", "starcontour.h"))
        self.version = ".".join(
            re.search(rf"^#define SC_VERSION_{part} (\d+)$", header, re.M).group(1)
            for part in ("MAJOR", "MINOR", "PATCH"))

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "*.md", "LICENSE", "include/*", "lib/*", "tests/ffi/*",
                        "tools/*.in", "tools/example.awk", "tools/install_binary.sh",
                        "tools/starcontour.schema.json"):
            copy(self, pattern, self.top, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeToolchain(self).generate()
        CMakeDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()

    def package_info(self):
        self.cpp_info.libs = ["starcontour"]
        self.cpp_info.set_property("cmake_file_name", "starcontour")
        self.cpp_info.set_property("cmake_target_name", "starcontour::starcontour")
        self.cpp_info.set_property("pkg_config_name", "starcontour")
        if self.settings.os == "Windows" and self.options.shared:
            self.cpp_info.defines = ["SC_SHARED"]
        if self.settings.os in ("Linux", "FreeBSD") and not self.options.shared:
            self.cpp_info.system_libs = ["m"]
