#!/usr/bin/env bash
# Fails on an include that points upward in the house (docs/architecture.md section 1: a folder uses only folders above it in the list),
# on Qt or the command line inside a library, and on a heavy header in a public header.
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
bad=0
forbid() {  # forbid FOLDER 'REGEX' WHY
    local hits
    hits=$(grep -rnE --include='*.h' --include='*.cpp' "^#include [\"<]($2)" "$1" 2>/dev/null)
    if [ -n "$hits" ]; then
        printf '%s may not include this (%s):\n%s\n' "$1" "$3" "$hits"
        bad=1
    fi
}
upward='a folder uses only folders above it'
forbid core 'geometry/|postproc/|surrogates/|cases/|studio/|tests/' "$upward"
forbid geometry 'postproc/|surrogates/|cases/|studio/|tests/' "$upward"
forbid postproc 'geometry/|surrogates/|cases/|studio/|tests/' "$upward"
forbid surrogates/tables 'geometry/|postproc/|surrogates/dynamics|surrogates/estimator|surrogates/discovery|cases/|studio/|tests/' "$upward"
forbid surrogates/dynamics 'geometry/|postproc/|surrogates/estimator|surrogates/discovery|cases/|studio/|tests/' "$upward"
forbid surrogates/estimator 'geometry/|postproc/|surrogates/discovery|cases/|studio/|tests/' "$upward"
forbid surrogates/discovery 'geometry/|postproc/|cases/|studio/|tests/' "$upward"
forbid cases 'studio/|tests/' "$upward"
for library in core geometry postproc surrogates cases; do
    forbid "$library" 'Q[A-Z][A-Za-z]+|qcustomplot|CLI/|spdlog/' 'libraries know nothing of Qt or the command line'
done
# Messages of libraries name no flags of the command line: they say "option 'unit mm'", which each front words its way.
# Not meant: what is handed to sbatch and the compiler, and what doctor says that a program is for.
hits=$(grep -rnE --include='*.h' --include='*.cpp' '"([^"\\]|\\.)*--[a-z]{2}' core geometry postproc surrogates cases 2>/dev/null |
    grep -vE '^(cases/(sweep_slurm|surroundings)\.cpp|surrogates/tables/exports/fmu_package\.cpp):|--nice=|^[^:]*:[0-9]+: *//')
if [ -n "$hits" ]; then
    printf 'flags of the command line in a library (write option '"'name value'"'):\n%s\n' "$hits"
    bad=1
fi
# Headers that only .cpp files of the importers include: they say so in their first lines.
inner='^postproc/importers/(hdf5/hdf5_numbers|hdf5/hdf5_chunks|hdf5/hdf5_handle|solver_number)\.h:'
for room in core geometry postproc surrogates cases; do
    hits=$(grep -rnE --include='*.h' '^#include <(CGAL/|OpenMesh/|toml\+\+/|nlohmann/json\.hpp|openturns|sundials|ceres/|hdf5|H5|cgnslib|fast_float/|SQLiteCpp)' "$room" 2>/dev/null | grep -vE "$inner")
    if [ -n "$hits" ]; then
        printf 'heavy libraries stop at a door, not in a header of %s:\n%s\n' "$room" "$hits"
        bad=1
    fi
done
hits=$(grep -rnE --include='*.h' '^#include <vtk' core geometry surrogates cases 2>/dev/null)
if [ -n "$hits" ]; then
    printf 'VTK types live in postproc and studio:\n%s\n' "$hits"
    bad=1
fi
# Importers hand fields to the rest of postproc; what loads, views and probes are made of is none of their affair.
hits=$(grep -rnE --include='*.h' --include='*.cpp' '^#include "postproc/(loads|views|probe)/' postproc/importers 2>/dev/null)
if [ -n "$hits" ]; then
    printf 'importers know nothing of loads, views and probes:\n%s\n' "$hits"
    bad=1
fi
# And the headers above stay with the importers.
hits=$(grep -rnE --include='*.h' --include='*.cpp' '^#include "postproc/importers/(hdf5/hdf5_numbers|hdf5/hdf5_chunks|hdf5/hdf5_handle|solver_number)\.h"' . 2>/dev/null | grep -vE '^\./(postproc/importers|tests|build)/')
if [ -n "$hits" ]; then
    printf 'headers of the importers alone:\n%s\n' "$hits"
    bad=1
fi
# Within a room, in the same way: what a sub-folder may not include.
forbid postproc/field 'postproc/(loads|views|probe)/' "$upward"
forbid postproc/loads 'postproc/(views|probe)/' "$upward"
forbid postproc/views 'postproc/probe/' "$upward"
forbid surrogates/tables/points 'surrogates/tables/(fit|analysis|exports|search)/' "$upward"
forbid surrogates/tables/fit 'surrogates/tables/(analysis|exports|search)/' "$upward"
forbid surrogates/tables/analysis 'surrogates/tables/(exports|search)/' "$upward"
forbid surrogates/tables/exports 'surrogates/tables/(analysis|search)/' "$upward"
forbid geometry/mesh 'geometry/(body|water|blocks|cases)/' "$upward"
forbid geometry/body 'geometry/(blocks|cases)/' "$upward"
forbid geometry/blocks 'geometry/cases/' "$upward"
forbid surrogates/dynamics/model 'surrogates/dynamics/(effects|plant|simulate|basin|linear|theory)/' "$upward"
forbid surrogates/dynamics/effects 'surrogates/dynamics/(simulate|basin|linear|theory)/' "$upward"
forbid surrogates/dynamics/plant 'surrogates/dynamics/(effects|simulate|basin|linear|theory)/' "$upward"
forbid surrogates/dynamics/simulate 'surrogates/dynamics/(basin|theory)/' "$upward"
exit $bad
