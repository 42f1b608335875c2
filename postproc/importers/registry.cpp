// The list of formats. A new one is one file beside this and one line here; the most specific come first.
#include "postproc/importers/importer.h"

#define UNDERBODY_IMPORTERS(X) \
    X(cfd_post_csv) \
    X(fluent_legacy) \
    X(fluent_hdf5) \
    X(fluent_ascii) \
    X(ensight) \
    X(cgns) \
    X(vtk_xml) \
    X(vtk_legacy) \
    X(openfoam) \
    X(tecplot) \
    X(surface_file)

namespace underbody::postproc {

#define UNDERBODY_DECLARE(name) Importer name##_importer();
UNDERBODY_IMPORTERS(UNDERBODY_DECLARE)
#undef UNDERBODY_DECLARE

const std::vector<Importer>& importers() {
#define UNDERBODY_LIST(name) name##_importer(),
    static const std::vector<Importer> all = {UNDERBODY_IMPORTERS(UNDERBODY_LIST)};
#undef UNDERBODY_LIST
    return all;
}

}  // namespace underbody::postproc
