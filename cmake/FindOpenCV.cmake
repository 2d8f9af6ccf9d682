# SPDX-License-Identifier: Apache-2.0
# find_package(OpenCV REQUIRED COMPONENTS core imgproc ...): targets opencv_core, opencv_imgproc, ... as OpenCV's own
# configuration has them. Debian ships that in libopencv-dev only, which brings all of OpenCV and its video libraries; libopencv-calib3d-dev
# is enough for us.
include(FindPackageHandleStandardArgs)
find_path(OpenCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
set(OpenCV_needed OpenCV_INCLUDE_DIR)
foreach(component IN LISTS OpenCV_FIND_COMPONENTS)
  find_library(OpenCV_${component}_LIBRARY opencv_${component})
  list(APPEND OpenCV_needed OpenCV_${component}_LIBRARY)
endforeach()
find_package_handle_standard_args(OpenCV REQUIRED_VARS ${OpenCV_needed})
mark_as_advanced(${OpenCV_needed})
if(OpenCV_FOUND)
  foreach(component IN LISTS OpenCV_FIND_COMPONENTS)
    if(NOT TARGET opencv_${component})
      add_library(opencv_${component} UNKNOWN IMPORTED)
      set_target_properties(opencv_${component} PROPERTIES IMPORTED_LOCATION "${OpenCV_${component}_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${OpenCV_INCLUDE_DIR}")
    endif()
  endforeach()
endif()
