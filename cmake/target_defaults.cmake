# What every target of this project is compiled with. No global flags: a project that adds this one
# with add_subdirectory keeps its own.
function(cs2mesh_target_defaults target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                              $<INSTALL_INTERFACE:include/cs2mesh>)
  # -ffp-contract=off: results must not depend on which products the compiler fuses.
  target_compile_options(${target} PRIVATE -Wall -Wextra -ffp-contract=off
                                           $<$<BOOL:${CS2MESH_WERROR}>:-Werror>)
  # GCC 12 reports overlapping copies inside std::string where there are none (its bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
endfunction()
