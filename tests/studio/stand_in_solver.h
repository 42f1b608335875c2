// A stand-in for OpenFOAM: programs of its names that write what it writes, as shell scripts do.
#pragma once

#include <filesystem>
#include <string>

#include "core/file.h"

namespace underbody::test {

inline void write_program(const std::filesystem::path& file, const std::string& script) {
    core::write_file(file, "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
}

/// Each case holds a file `meshed` of one line, and a further one for each time that a mesh is made again on which a
/// solver had begun (a mesh that was cut while the mesher ran has to be made again). $HOOK: a file of shell code that
/// the solver reads at every iteration ($i).
inline const char* const fake_solver = R"sh(touch whole
end=$(sed -n 's/^endTime \([0-9]*\);.*/\1/p' system/controlDict)
every=$(sed -n 's/^writeInterval \([0-9]*\);.*/\1/p' system/controlDict)
from=0
for d in [1-9]*; do if [ -e "$d/U" ] && [ "$d" -gt "$from" ]; then from=$d; fi; done
mkdir -p postProcessing/forces/$from
f=postProcessing/forces/$from/force.dat
echo '# Time (total_x total_y total_z) (pressure_x pressure_y pressure_z) (viscous_x viscous_y viscous_z)' > $f
field() {
    printf 'FoamFile\n{\n    version 2.0;\n    format ascii;\n    class %s;\n    object %s;\n}\n' $2 $1
    printf 'dimensions [0 1 -1 0 0 0 0];\ninternalField nonuniform List<%s>\n4\n(\n%s\n%s\n%s\n%s\n)\n;\n' $3 "$4" "$4" "$4" "$4"
    printf 'boundaryField\n{\n}\n\n// ************************************************************************* //\n'
}
i=$from
while [ $i -lt $end ]; do
    i=$((i + 1))
    echo
    echo "Time = $i"
    echo "ExecutionTime = $i.5 s  ClockTime = $i s"
    echo "$i (-1.5 0 2) (-1 0 2) (-0.5 0 0)" >> $f
    if [ $((i % every)) = 0 ]; then
        mkdir -p $i
        field U volVectorField vector '(1 0 0)' > $i/U
        for v in p k omega nut; do field $v volScalarField scalar 1 > $i/$v; done
    fi
    if [ -e "$HOOK" ]; then . "$HOOK"; fi
done
echo
echo End
)sh";

inline void write_stand_in_solver(const std::filesystem::path& folder) {
    write_program(folder / "blockMesh",
                  "mkdir -p constant/polyMesh\n"
                  "printf 'FoamFile\\n{\\n    class labelList;\\n    note \"nPoints:20  nCells:4  nFaces:21  "
                  "nInternalFaces:3\";\\n}\\n' > constant/polyMesh/owner\n"
                  "if [ -e whole ]; then echo again >> meshed; else echo meshed > meshed; fi");
    write_program(folder / "surfaceFeatureExtract", "true");
    write_program(folder / "snappyHexMesh", "true");
    write_program(folder / "checkMesh", "echo 'Mesh OK.'; echo; echo End");
    write_program(folder / "simpleFoam", fake_solver);
    // By MPI the solver runs in processor0, and `cores` has a line of how many were asked for.
    write_program(folder / "decomposePar",
                  "mkdir -p processor0 processor1 postProcessing\n"
                  "for d in [1-9]*; do if [ -e \"$d/U\" ]; then cp -r \"$d\" processor0/; fi; done\n"
                  "ln -sfn ../system processor0/system; ln -sfn ../postProcessing processor0/postProcessing");
    write_program(folder / "mpirun", "echo \"$2\" >> cores\ncd processor0 && exec simpleFoam");
    write_program(folder / "reconstructPar",
                  "for d in processor0/[1-9]*; do if [ -e \"$d/U\" ]; then cp -r \"$d\" .; fi; done");
}

}  // namespace underbody::test
