find_package(Threads REQUIRED)
find_package(TBB CONFIG REQUIRED)

# OpenVDB ships a find module only, in a folder of its own that also holds FindTBB and others.
list(APPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)
find_package(OpenVDB 10 REQUIRED COMPONENTS openvdb)
list(POP_BACK CMAKE_MODULE_PATH)

if(CS2MESH_WITH_CGAL)
  find_package(CGAL 5.5 REQUIRED)
endif()

find_package(CLI11 CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(TinyGLTF CONFIG REQUIRED)
find_package(PNG REQUIRED)

if(CS2MESH_BUILD_TESTS)
  find_package(GTest CONFIG REQUIRED)
  find_package(rapidcheck CONFIG REQUIRED)
  find_package(Boost 1.74 REQUIRED)
endif()
if(CS2MESH_BUILD_BENCH)
  find_package(benchmark CONFIG REQUIRED)
endif()
