"""Conan 2: the headers of motiongan and the library of its C interface, from the sources that this file lies in."""
import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load


class Motiongan(ConanFile):
    name = "motiongan"
    description = "Generative adversarial networks of human motion over OpenCL"
    license = "MIT"
    package_type = "shared-library"
    settings = "os", "arch", "compiler", "build_type"

    @property
    def _project(self):
        return os.path.join(self.recipe_folder, os.pardir, os.pardir)

    def set_version(self):
        text = load(self, os.path.join(self._project, "CMakeLists.txt"))
        self.version = re.search(r"project\(motiongan VERSION (\S+)", text).group(1)

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "c/*", "cl/*", "cmake/*", "include/*", "packaging/copyright.in",
                        "packaging/python/*", "view/*"):
            copy(self, pattern, self._project, self.export_sources_folder)

    def requirements(self):
        for reference in ("clblast/1.7.0", "nlohmann_json/3.11.3", "opencl-headers/2025.07.22",
                          "opencl-icd-loader/2025.07.22", "zlib/[>=1.2.11 <2]"):
            self.requires(reference, transitive_headers=True, transitive_libs=True)

    def validate(self):
        check_min_cppstd(self, 20)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        for part in ("TOOLS", "TESTS", "EXAMPLES", "BENCHMARKS"):
            toolchain.cache_variables[f"MOTIONGAN_BUILD_{part}"] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()

    def package_info(self):
        # The package's own motiongan-config.cmake and .pc files describe it.
        self.cpp_info.libs = ["motiongan"]
        self.cpp_info.builddirs.append(os.path.join("lib", "cmake", "motiongan"))
        self.cpp_info.set_property("cmake_find_mode", "none")
