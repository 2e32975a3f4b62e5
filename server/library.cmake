# One folder is one static library; `DEPS` are the only folders it may include, which
# tests/layers_test.py checks against the sources.

# mane_library(<folder> SOURCES ... DEPS <mane_x> ... LIBS <external> ...)
function(mane_library folder)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;LIBS" ${ARGN})
  add_library(mane_${folder} STATIC ${ARG_SOURCES})
  target_include_directories(mane_${folder} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_FUNCTION_LIST_DIR}> $<INSTALL_INTERFACE:include/mane/server>)
  target_link_libraries(mane_${folder} PUBLIC ${ARG_DEPS} ${ARG_LIBS})
  set_target_properties(mane_${folder} PROPERTIES EXPORT_NAME ${folder})
endfunction()

# mane_unit_tests(<folder> SOURCES ... LIBS ...): the tests beside the code, as one program.
function(mane_unit_tests folder)
  if(NOT MANE_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${folder}_test ${ARG_SOURCES})
  target_link_libraries(${folder}_test PRIVATE mane_${folder} ${ARG_LIBS} GTest::gtest_main)
  gtest_discover_tests(${folder}_test TEST_PREFIX "${folder}." DISCOVERY_TIMEOUT 60)
endfunction()
