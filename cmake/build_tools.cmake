# Faster builds where the tools are there; only for this project built by itself.
if(PROJECT_IS_TOP_LEVEL)
  find_program(CS2MESH_CCACHE ccache)
  if(CS2MESH_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    # Clones share what is compiled; the price is that debuggers may find the sources of another.
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
        CCACHE_NOHASHDIR=1 ${CS2MESH_CCACHE})
  endif()
  find_program(CS2MESH_MOLD mold)
  if(CS2MESH_MOLD)
    add_link_options(-fuse-ld=mold)
  endif()
endif()
