// The list of formats. A new one is one file beside this and one line here; the most specific come first.
#include "postproc/field/lists.h"
#include "postproc/importers/importer.h"

#define UNDERBODY_IMPORTERS(X)                                                        \
    X(cfd_post_csv, ".csv exported by CFD-Post or CFX, blocks [Name] [Data] [Faces]") \
    X(fluent_legacy, ".cas, .dat, .msh of Fluent, also .gz, ASCII or binary")         \
    X(fluent_hdf5, ".cas.h5, .dat.h5, .msh.h5 of Fluent")                             \
    X(fluent_ascii, "text that Fluent exports: nodenumber or cellnumber and columns") \
    X(ensight, ".case or .encas of EnSight Gold with its .geo and variables")         \
    X(cgns, ".cgns of CFX, Fluent, ICEM and others, ADF or HDF5")                     \
    X(paraview_collection, ".pvd of ParaView: VTK files with their times")            \
    X(vtk_xml, ".vtu, .vtp, .vtm and other XML files of VTK")                         \
    X(vtk_legacy, ".vtk")                                                             \
    X(openfoam, "the folder of an OpenFOAM case")                                     \
    X(tecplot, ".dat, .plt of Tecplot, ASCII")                                        \
    X(surface_file, ".stl, .obj, .ply: surfaces without values")

namespace underbody::postproc {

#define UNDERBODY_DECLARE(name, files) Importer name##_importer();
UNDERBODY_IMPORTERS(UNDERBODY_DECLARE)
#undef UNDERBODY_DECLARE

const std::vector<Importer>& importers() {
#define UNDERBODY_LIST(name, files) name##_importer(),
    static const std::vector<Importer> all = {UNDERBODY_IMPORTERS(UNDERBODY_LIST)};
#undef UNDERBODY_LIST
    return all;
}

const std::vector<CfdFormat>& cfd_formats() {
#define UNDERBODY_DESCRIBE(name, files) {name##_importer().format, files},
    static const std::vector<CfdFormat> all = {UNDERBODY_IMPORTERS(UNDERBODY_DESCRIBE)};
#undef UNDERBODY_DESCRIBE
    return all;
}

}  // namespace underbody::postproc
