// A real OpenFOAM run on the spot: a box whose lid drags the water along, its forces by the solver and by us.
#include <gmock/gmock.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/file.h"
#include "postproc/loads/stated_loads.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

namespace fs = std::filesystem;

/// The files of the case: 16 x 12 x 10 cells, laminar, forces on three of its six walls about a point of their own.
const std::vector<std::pair<std::string, std::string>>& case_files() {
    static const std::vector<std::pair<std::string, std::string>> files = {
        {"system/blockMeshDict", R"foam(FoamFile { version 2.0; format ascii; class dictionary; object blockMeshDict; }
scale 1;
vertices ((0 0 0) (1 0 0) (1 0.6 0) (0 0.6 0) (0 0 0.3) (1 0 0.3) (1 0.6 0.3) (0 0.6 0.3));
blocks (hex (0 1 2 3 4 5 6 7) (16 12 10) simpleGrading (1 1 1));
edges ();
boundary ( lid { type wall; faces ((3 7 6 2)); } floor { type wall; faces ((0 1 5 4)); } left { type wall; faces ((0 4 7 3)); } right { type wall; faces ((1 2 6 5)); } back { type wall; faces ((0 3 2 1)); } front { type wall; faces ((4 5 6 7)); } );
mergePatchPairs ();
)foam"},
        {"system/controlDict", R"foam(FoamFile { version 2.0; format ascii; class dictionary; object controlDict; }
application simpleFoam; startFrom latestTime; startTime 0; stopAt endTime; endTime 30; deltaT 1; writeControl timeStep; writeInterval 30; writeFormat ascii; writePrecision 10; timeFormat general; timePrecision 6; runTimeModifiable false;
functions
{
 forces { type forces; libs ("libforces.so"); writeControl timeStep; writeInterval 1; patches (floor lid right); rho rhoInf; rhoInf 998; CofR (0.5 0.3 0.1); }
 wallShearStress { type wallShearStress; libs ("libfieldFunctionObjects.so"); writeControl writeTime; }
}
)foam"},
        {"system/fvSchemes", R"foam(FoamFile { version 2.0; format ascii; class dictionary; object fvSchemes; }
ddtSchemes { default steadyState; } gradSchemes { default Gauss linear; } divSchemes { default none; div(phi,U) bounded Gauss upwind; div((nuEff*dev2(T(grad(U))))) Gauss linear; } laplacianSchemes { default Gauss linear corrected; } interpolationSchemes { default linear; } snGradSchemes { default corrected; }
)foam"},
        {"system/fvSolution", R"foam(FoamFile { version 2.0; format ascii; class dictionary; object fvSolution; }
solvers { p { solver PCG; preconditioner DIC; tolerance 1e-8; relTol 0.01; } U { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-9; relTol 0.01; } }
SIMPLE { nNonOrthogonalCorrectors 0; pRefCell 0; pRefValue 0; }
relaxationFactors { fields { p 0.3; } equations { U 0.7; } }
)foam"},
        {"constant/transportProperties",
         R"foam(FoamFile { version 2.0; format ascii; class dictionary; object transportProperties; }
transportModel Newtonian; nu 0.01;
)foam"},
        {"constant/turbulenceProperties",
         R"foam(FoamFile { version 2.0; format ascii; class dictionary; object turbulenceProperties; }
simulationType laminar;
)foam"},
        {"0/U", R"foam(FoamFile { version 2.0; format ascii; class volVectorField; object U; }
dimensions [0 1 -1 0 0 0 0]; internalField uniform (0 0 0); boundaryField { lid { type fixedValue; value uniform (1 0 0); } ".*" { type noSlip; } }
)foam"},
        {"0/p", R"foam(FoamFile { version 2.0; format ascii; class volScalarField; object p; }
dimensions [0 2 -2 0 0 0 0]; internalField uniform 0; boundaryField { ".*" { type zeroGradient; } }
)foam"},
    };
    return files;
}

TEST(LoadsOfOpenFoam, AreThoseOfTheSolver) {
    if (!fs::exists("/usr/bin/simpleFoam") || !fs::exists("/usr/bin/blockMesh")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not here (apt install openfoam)";
    }
    const core::TemporaryFolder folder;
    for (const auto& [name, text] : case_files()) {
        core::write_file(folder.path() / name, text);
    }
    const std::map<std::string, std::string> environment = {{"WM_PROJECT_DIR", "/usr/share/openfoam"}};
    for (const char* program : {"/usr/bin/blockMesh", "/usr/bin/simpleFoam"}) {
        const auto run = test::run_program(program, {}, folder.path(), environment);
        ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
    }
    LoadsOptions options;
    options.zones = {"floor", "lid", "right"};
    options.reference = Vector{0.2, 0.1, 0.05};  // not the solver's point
    options.references.density = 998;
    const LoadsResult result = loads(read_field(folder.path()), options);
    EXPECT_EQ(result.values_from, "faces");
    core::Problems notes;
    const auto comparisons = compare_with_solver(result, stated_beside(folder.path(), result), notes);
    EXPECT_TRUE(notes.empty());
    ASSERT_EQ(comparisons.size(), 18U);  // three forces and three moments, whole, by pressure and by friction
    for (const auto& one : comparisons) {
        EXPECT_LT(one.of_force, 1e-6) << one.quantity << ": " << one.value << ", the solver says " << one.stated;
    }
}

}  // namespace
}  // namespace underbody::postproc
