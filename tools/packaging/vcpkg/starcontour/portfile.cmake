# An overlay port for vcpkg that builds starcontour from the checkout or archive it lies in.
#
# SPDX-License-Identifier: MIT
#
#   vcpkg install starcontour --overlay-ports=tools/packaging/vcpkg
#
# An example of a port; tests/packages/vcpkg.sh runs it where there is vcpkg, and else only reads
# it, with stand-ins for vcpkg's functions. One for a registry would take the sources from a
# released archive (vcpkg_from_github) instead of the folder above.
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../../.." ABSOLUTE)

vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}")
vcpkg_cmake_install()
vcpkg_copy_pdbs()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/starcontour)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
