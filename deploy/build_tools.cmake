# Faster builds where the tools are installed; included by the presets before the first target.
find_program(MANE_CCACHE ccache)
if(MANE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${MANE_CCACHE})
endif()
find_program(MANE_MOLD mold)
if(MANE_MOLD)
  add_link_options(-fuse-ld=mold)
endif()
