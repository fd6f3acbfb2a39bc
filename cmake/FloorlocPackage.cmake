# SPDX-License-Identifier: Apache-2.0
# What 'cmake --install' installs, below any prefix, and the Debian package that CPack makes ('./run package').
include(GNUInstallDirs)
set(ops ${CMAKE_SOURCE_DIR}/server/ops)
set(CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                                                WORLD_READ WORLD_EXECUTE)

install(TARGETS floorloc-mapbuilder floorloc-server floorloc-bridge RUNTIME COMPONENT floorloc)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT floorloc FILES_MATCHING PATTERN *.md)
install(FILES schema/openapi.yaml schema/map.sql ${ops}/alerts.yml ${ops}/grafana-dashboard.json
  DESTINATION ${CMAKE_INSTALL_DATADIR}/floorloc COMPONENT floorloc)
install(FILES ${ops}/server.example.json ${ops}/bridge.example.json
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT floorloc)

# The clients, for programs of others: not part of the package of the programs.
install(TARGETS floorloc_client ARCHIVE COMPONENT client)
file(GLOB client_headers CONFIGURE_DEPENDS clients/cpp/*.h)
install(FILES ${client_headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/floorloc/clients/cpp COMPONENT client)
file(RELATIVE_PATH prefix_from_pkgconfig /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(clients/cpp/floorloc-client.pc.in ${CMAKE_BINARY_DIR}/floorloc-client.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/floorloc-client.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT client)
install(DIRECTORY clients/python/ DESTINATION ${CMAKE_INSTALL_DATADIR}/floorloc/python COMPONENT client
  PATTERN __pycache__ EXCLUDE)

# What belongs to the system, for the package only: a prefix has no place for it.
install(FILES ${ops}/floorloc-server.service ${ops}/floorloc-bridge.service DESTINATION /lib/systemd/system
  COMPONENT system EXCLUDE_FROM_ALL)
install(FILES ${ops}/floorloc-server.default DESTINATION /etc/default RENAME floorloc-server COMPONENT system
  EXCLUDE_FROM_ALL)
install(FILES ${ops}/server.json DESTINATION /etc/floorloc COMPONENT system EXCLUDE_FROM_ALL)
install(FILES ${ops}/debian/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT system EXCLUDE_FROM_ALL)

# --- manual pages, where help2man is installed ----------------------------------------------------------------------

add_custom_target(man_pages)

# floorloc_man_page(PAGE TARGET [SUBCOMMAND name] INCLUDE file)
function(floorloc_man_page page target)
  cmake_parse_arguments(ARG "" "SUBCOMMAND;INCLUDE" "" ${ARGN})
  set(output ${CMAKE_BINARY_DIR}/man/${page}.1)
  add_custom_command(
    OUTPUT ${output}.gz
    COMMAND ${HELP2MAN} --no-info --version-string=${PROJECT_VERSION} --include=${ARG_INCLUDE} --output=${output}
            "--help-option=${ARG_SUBCOMMAND} --help" $<TARGET_FILE:${target}>
    COMMAND gzip -9nf ${output}
    DEPENDS ${target} ${ARG_INCLUDE}
    VERBATIM)
  add_custom_target(man_page_${page} DEPENDS ${output}.gz)
  add_dependencies(man_pages man_page_${page})
  install(FILES ${output}.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT floorloc OPTIONAL)
endfunction()

find_program(HELP2MAN help2man)
if(HELP2MAN)
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/man)
  floorloc_man_page(floorloc-server floorloc-server INCLUDE ${ops}/floorloc-server.h2m)
  floorloc_man_page(floorloc-bridge floorloc-bridge INCLUDE ${ops}/floorloc-bridge.h2m)
  floorloc_man_page(floorloc-mapbuilder floorloc-mapbuilder
    INCLUDE ${CMAKE_SOURCE_DIR}/mapbuilder/cli/floorloc-mapbuilder.h2m)
  file(GLOB commands CONFIGURE_DEPENDS mapbuilder/cli/*_command.cpp)
  foreach(source ${commands})
    file(READ ${source} text)
    string(REGEX MATCH "add_subcommand\\([ \n]*\"([a-z-]+)\",[ \n]*\"([^.:;\"]+)" unused "${text}")
    set(subcommand ${CMAKE_MATCH_1})
    set(include ${CMAKE_BINARY_DIR}/man/${subcommand}.h2m)
    string(REPLACE "-" "\\-" description "${CMAKE_MATCH_2}")
    file(CONFIGURE OUTPUT ${include}
      CONTENT "[NAME]\nfloorloc-mapbuilder-${subcommand} \\- ${description}\n\n[SEE ALSO]\n\\fBfloorloc\\-mapbuilder\\fR(1)\n")
    floorloc_man_page(floorloc-mapbuilder-${subcommand} floorloc-mapbuilder SUBCOMMAND ${subcommand}
      INCLUDE ${include})
  endforeach()
endif()

# --- Debian package -------------------------------------------------------------------------------------------------

set(debian ${CMAKE_BINARY_DIR}/debian)
file(STRINGS ${ops}/debian/changelog newest LIMIT_COUNT 1)
if(NOT newest MATCHES "^floorloc \\(${PROJECT_VERSION}-([0-9]+)\\)")
  message(FATAL_ERROR "server/ops/debian/changelog has no entry for version ${PROJECT_VERSION}")
endif()
set(CPACK_DEBIAN_PACKAGE_RELEASE ${CMAKE_MATCH_1})
foreach(text CHANGELOG.md:changelog server/ops/debian/changelog:changelog.Debian)
  string(REPLACE ":" ";" text ${text})
  list(GET text 0 source)
  list(GET text 1 name)
  add_custom_command(
    OUTPUT ${debian}/${name}.gz
    COMMAND gzip -9nc ${CMAKE_SOURCE_DIR}/${source} > ${debian}/${name}.gz
    DEPENDS ${source})
  install(FILES ${debian}/${name}.gz DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT system EXCLUDE_FROM_ALL)
endforeach()
file(MAKE_DIRECTORY ${debian})
add_custom_target(package_files DEPENDS ${debian}/changelog.gz ${debian}/changelog.Debian.gz man_pages
  floorloc-server floorloc-bridge floorloc-mapbuilder)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME floorloc)
set(CPACK_PACKAGE_VENDOR "The floorloc project")
set(CPACK_PACKAGE_CONTACT "The floorloc project <maintainers@floorloc.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "localization of vehicles by images of the floor")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"Floors of concrete, wood, carpet or asphalt look homogeneous and are unique\n\
everywhere. floorloc-mapbuilder makes a map of a floor from images of a\n\
calibrated camera; floorloc-server finds the images of a fleet of vehicles in\n\
it, with millimetre accuracy, and tracks their poses, over HTTP;\n\
floorloc-bridge brings them to a VDA 5050 master control, over MQTT.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "init-system-helpers (>= 1.54~)")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "systemd")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
  "${ops}/debian/conffiles;${ops}/debian/postinst;${ops}/debian/prerm;${ops}/debian/postrm")
set(CPACK_STRIP_FILES ON)
set(CPACK_SET_DESTDIR ON)  # for what lies outside of /usr
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_CMAKE_PROJECTS
  "${CMAKE_BINARY_DIR};floorloc;floorloc;/;${CMAKE_BINARY_DIR};floorloc;system;/")
include(CPack)
