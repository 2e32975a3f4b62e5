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

# mane_kernels(<variable>): the batched kernels of this folder, batch_kernel_<isa>.cpp, one source for
# each instruction set of the architecture, with the instructions that it may use. Fused
# multiplication and addition is theirs to choose; what must be equal bit for bit is equal within one
# kernel.
function(mane_kernels variable)
  set(options -O3 -ffp-contract=fast -fno-math-errno -fno-signed-zeros -fno-trapping-math -Wno-psabi)
  set(sources batch_kernel_scalar.cpp)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND sources batch_kernel_avx2.cpp batch_kernel_avx512.cpp)
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
    list(APPEND sources batch_kernel_neon.cpp)
  endif()
  set_source_files_properties(${sources} PROPERTIES COMPILE_OPTIONS "${options}")
  set_source_files_properties(batch_kernel_avx2.cpp PROPERTIES
    COMPILE_OPTIONS "${options};-mavx2;-mfma;-mtune=skylake-avx512")
  set_source_files_properties(batch_kernel_avx512.cpp PROPERTIES COMPILE_OPTIONS
    "${options};-mavx512f;-mavx512bw;-mavx512dq;-mavx512vl;-mfma;-mprefer-vector-width=512")
  set(${variable} ${sources} PARENT_SCOPE)
endfunction()
