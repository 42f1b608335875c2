# Every library the project stands on; all of them Debian 12 packages (see scripts in cases/run and tests/run).
# The same file serves the installed package.
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(nlohmann_json REQUIRED)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
find_path(UDUNITS2_INCLUDE udunits2.h PATH_SUFFIXES udunits2 REQUIRED)
find_library(UDUNITS2_LIBRARY udunits2 REQUIRED)
find_package(ZLIB REQUIRED)

# CONFIG, because VTK and CGAL put find modules of their own in the way.
find_package(Eigen3 CONFIG REQUIRED)
find_package(OpenMesh CONFIG REQUIRED)
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
find_package(CGAL QUIET REQUIRED)
find_package(VTK 9.1 REQUIRED COMPONENTS
  CommonCore CommonDataModel CommonExecutionModel CommonMath CommonTransforms CommonSystem
  FiltersCore FiltersGeneral FiltersHybrid FiltersGeometry FiltersSources FiltersExtraction FiltersModeling FiltersFlowPaths FiltersVerdict
  IOCore IOXML IOLegacy IOGeometry IOEnSight IOCGNSReader IOImage IOParallel
  ImagingCore InteractionStyle InteractionWidgets RenderingAnnotation RenderingCore RenderingFreeType
  RenderingOpenGL2 RenderingContextOpenGL2 GUISupportQt)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(SUNDIALS CONFIG REQUIRED COMPONENTS cvode nvecserial sunmatrixdense sunlinsoldense)
find_package(SQLiteCpp CONFIG REQUIRED)
find_library(CGNS_LIBRARY cgns REQUIRED)
find_library(MATIO_LIBRARY matio REQUIRED)
find_library(NLOPT_LIBRARY nlopt REQUIRED)
find_package(LAPACK REQUIRED)
# Logs of vehicles: CDR of ROS 2, compressed chunks of MCAP.
find_package(fastcdr CONFIG REQUIRED)
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
