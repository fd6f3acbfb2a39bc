# SPDX-License-Identifier: Apache-2.0
# Debian's libmosquitto-dev has no CMake package: imports the library as mosquitto::mosquitto.
find_path(mosquitto_INCLUDE_DIR mosquitto.h)
find_library(mosquitto_LIBRARY mosquitto)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(mosquitto REQUIRED_VARS mosquitto_LIBRARY mosquitto_INCLUDE_DIR)

if(mosquitto_FOUND AND NOT TARGET mosquitto::mosquitto)
  add_library(mosquitto::mosquitto UNKNOWN IMPORTED)
  set_target_properties(mosquitto::mosquitto PROPERTIES IMPORTED_LOCATION ${mosquitto_LIBRARY}
                                                        INTERFACE_INCLUDE_DIRECTORIES ${mosquitto_INCLUDE_DIR})
endif()
