#include "geometry/cases/solver_script.h"

namespace underbody::geometry {

std::string solver_functions() {
    // Slices along the stream of equally many cells: scotch is not in every OpenFOAM (not in Debian's).
    return R"sh(failed() {
    echo "$1 failed: see $(pwd)/log.$1" >&2; tail -n 5 "log.$1" >&2; exit "$2"
}
# UNDERBODY_CORES=4 ./Allrun: on four cores by MPI.
cores=${UNDERBODY_CORES:-1}
solver() {
    if [ "$cores" -le 1 ]; then
        simpleFoam -case "$1" >> "log.$2" 2>&1 || failed "$2" $?
        return
    fi
    printf 'FoamFile\n{\n    version 2.0;\n    format ascii;\n    class dictionary;\n    object decomposeParDict;\n}\n%s\n' \
        "numberOfSubdomains $cores; method simple; coeffs { n ($cores 1 1); }" > "$1/system/decomposeParDict"
    decomposePar -case "$1" -latestTime -force > log.decomposePar 2>&1 || failed decomposePar $?
    OMPI_MCA_hwloc_base_binding_policy=none mpirun -np "$cores" simpleFoam -parallel -case "$1" >> "log.$2" 2>&1 || failed "$2" $?
    reconstructPar -case "$1" -latestTime > log.reconstructPar 2>&1 || failed reconstructPar $?
    rm -rf "$1"/processor*
}
)sh";
}

}  // namespace underbody::geometry
