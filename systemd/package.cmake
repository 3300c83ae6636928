# The Debian packages: cpack -G DEB in the build folder, after a build of release. The station, and
# beside it the import of STEP and IGES, which brings OpenCASCADE.
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
get_cmake_property(CPACK_COMPONENTS_ALL COMPONENTS)
set(CPACK_PACKAGE_NAME binpick)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "binpick maintainers <maintainers@binpick.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Bin-picking vision station")
set(CPACK_COMPONENT_STATION_DESCRIPTION
  "Bin-picking vision station
 Learns parts from their CAD files, finds their 6D poses in a pile with an industrial 3D sensor, and
 hands ranked picks to a PLC or robot over Modbus TCP. A daemon, binpickd, and a command line,
 binpick.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# procps: /bin/kill, by which the unit is reloaded.
set(CPACK_DEBIAN_STATION_PACKAGE_DEPENDS "systemd, init-system-helpers, procps")
set(CPACK_DEBIAN_STATION_PACKAGE_NAME binpick)
set(CPACK_DEBIAN_STATION_PACKAGE_RECOMMENDS "udev")
set(CPACK_DEBIAN_STATION_PACKAGE_SUGGESTS "binpick-cad")
set(CPACK_DEBIAN_CAD_PACKAGE_NAME binpick-cad)
set(CPACK_COMPONENT_CAD_DESCRIPTION
  "STEP and IGES for binpick
 Turns STEP and IGES files into triangles, for binpick train. A station that only runs does without
 it.")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_STATION_PACKAGE_CONTROL_EXTRA
  ${CMAKE_CURRENT_LIST_DIR}/debian/postinst ${CMAKE_CURRENT_LIST_DIR}/debian/prerm
  ${CMAKE_CURRENT_LIST_DIR}/debian/postrm)
include(CPack)
