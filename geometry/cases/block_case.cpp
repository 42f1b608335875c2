// The OpenFOAM case of a body of the family on its mesh of blocks.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "geometry/cases/case_files.h"
#include "geometry/cases/flow_domain.h"
#include "geometry/cases/solver_script.h"

namespace underbody::geometry {

namespace {

namespace fs = std::filesystem;

/// Iterations with upwind schemes before the others: fields that stand still would diverge in second order.
constexpr int start_iterations = 60;

constexpr const char* schemes_head =
    "ddtSchemes { default steadyState; }\n"
    "gradSchemes\n{\n    default Gauss linear;\n    grad(U) cellLimited Gauss linear 1;\n    grad(k) cellLimited Gauss "
    "linear 1;\n    grad(omega) cellLimited Gauss linear 1;\n}\n";
constexpr const char* schemes_tail =
    "laplacianSchemes { default Gauss linear limited corrected 0.5; }\ninterpolationSchemes { default linear; }\n"
    "snGradSchemes { default limited corrected 0.5; }\nwallDist { method meshWave; }\n";

std::string schemes(bool start) {
    const std::string velocity = start ? "upwind" : "linearUpwind grad(U)",
                      other = start ? "upwind" : "limitedLinear 1";
    return foam_header("dictionary", "fvSchemes") + schemes_head +
           "divSchemes\n{\n    default none;\n    div(phi,U) bounded Gauss " + velocity +
           ";\n    div(phi,k) bounded Gauss " + other + ";\n    div(phi,omega) bounded Gauss " + other +
           ";\n    div((nuEff*dev2(T(grad(U))))) Gauss linear;\n}\n" + schemes_tail;
}

std::string solution(bool start) {
    return foam_header("dictionary", "fvSolution") +
           "solvers\n{\n    p\n    {\n        solver PCG;\n        preconditioner\n        {\n            "
           "preconditioner "
           "GAMG;\n            smoother DIC;\n            nPreSweeps 0;\n            nPostSweeps 2;\n            "
           "tolerance 1e-9;\n            relTol 0.05;\n            nVcycles 1;\n            cacheAgglomeration true;\n"
           "            nCellsInCoarsestLevel 200;\n            agglomerator faceAreaPair;\n            mergeLevels "
           "1;\n"
           "        }\n        tolerance 1e-9;\n        relTol 0.03;\n        maxIter 60;\n    }\n"
           "    \"(U|k|omega)\"\n    {\n        solver smoothSolver;\n        smoother symGaussSeidel;\n"
           "        tolerance 1e-10;\n        relTol 0.1;\n        nSweeps 1;\n        maxIter 10;\n    }\n}\n\n"
           "SIMPLE\n{\n    nNonOrthogonalCorrectors 0;\n    consistent " +
           (start ? "no" : "yes") +
           ";\n    pRefCell 0;\n    pRefValue 0;\n    residualControl { p 2e-6; U 1e-7; }\n}\n\nrelaxationFactors\n{\n"
           "    fields { p " +
           (start ? "0.3" : "1") + "; }\n    equations { U " + (start ? "0.6" : "0.9") + "; \"(k|omega)\" " +
           (start ? "0.5" : "0.7") + "; }\n}\n";
}

class BlockCaseWriter {
public:
    BlockCaseWriter(const BodyShape& shape, const FlowOptions& options, fs::path folder, core::Progress& progress)
        : shape_(shape), o_(options), folder_(std::move(folder)), progress_(progress) {
        o_.mesher = CaseMesher::blocks;
    }

    BlockCase write() {
        require_empty_folder(folder_);
        if (o_.jet_flow < 0 || !std::isfinite(o_.jet_flow)) {
            throw core::InputError("range", "a jet of " + core::format_number(o_.jet_flow, 6) + " m^3/s", {},
                                   "the nearest allowed value: 0, no jet");
        }
        if (o_.jet_flow > 0 && !shape_.nozzle) {
            throw core::InputError("missing", "the body '" + shape_.name + "' has no nozzle for a jet", {},
                                   "a [nozzle] in its SHAPE.toml, or no jet");
        }
        const BlockMeshOptions mesh{o_.placement, o_.mesh_density, o_.half, o_.speed, o_.kinematic_viscosity};
        made_.mesh = make_block_mesh(shape_, mesh, progress_);
        const std::vector<std::string> openings(o_.jet_flow > 0 ? 1 : 0, "nozzle");
        for (const auto& file : write_poly_mesh(made_.mesh.mesh, folder_, openings)) {
            made_.files.push_back(file);
        }
        put("constant/mesh.json", rounded(made_.mesh).dump(1) + "\n");
        const int all = iterations_of(o_), start = std::min(start_iterations, std::max(1, all / 3));
        put("system/controlDict", control(all, checkpoint_interval(all), true));
        put("system/fvSchemes", schemes(false));
        put("system/fvSolution", solution(false));
        put("start/system/controlDict", control(start, start, false));
        put("start/system/fvSchemes", schemes(true));
        put("start/system/fvSolution", solution(true));
        put("constant/transportProperties", foam_transport(o_.kinematic_viscosity));
        put("constant/turbulenceProperties", foam_turbulence());
        fields();
        put("Allrun", run(start));
        make_executable(folder_ / "Allrun");
        return std::move(made_);
    }

private:
    void put(const std::string& name, const std::string& text) {
        core::write_file(folder_ / name, text);
        made_.files.push_back(folder_ / name);
    }

    /// Six digits: the same mesh of another compiler differs in its last ones.
    static nlohmann::json rounded(const BlockMesh& mesh) {
        nlohmann::json json = mesh;
        for (auto& value : json) {
            if (value.is_number_float()) {
                value = core::parse_number(core::format_number(value.get<double>(), 6)).value_or(0);
            }
        }
        return json;
    }

    std::string control(int iterations, int interval, bool watched) const {
        std::string walls;
        for (const std::string& wall : made_.mesh.walls) {
            walls += (walls.empty() ? "" : " ") + wall;
        }
        const std::string functions =
            "functions\n{\n    // Forces in N on " +
            std::string(o_.half ? "the half body: twice them is the whole" : "the whole body") +
            "; moments about the centre of the base.\n    forces\n    {\n        type forces;\n        libs "
            "(\"libforces.so\");\n        writeControl timeStep;\n        writeInterval 1;\n        log false;\n       "
            " "
            "patches (" +
            walls + ");\n        rho rhoInf;\n        rhoInf " + digits(o_.density) + ";\n        CofR (0 0 " +
            digits(o_.placement.gap) + ");\n        lRef " + digits(shape_.length) +
            ";\n    }\n    wallShearStress\n    {\n        type wallShearStress;\n        libs "
            "(\"libfieldFunctionObjects.so\");\n        writeControl writeTime;\n    }\n"
            "    yPlus\n    {\n        type yPlus;\n        libs (\"libfieldFunctionObjects.so\");\n        "
            "writeControl writeTime;\n    }\n    // The run ends, and is written, when this file appears.\n"
            "    settled\n    {\n        type abort;\n        libs (\"libutilityFunctionObjects.so\");\n        "
            "file \"$FOAM_CASE/settled\";\n        action writeNow;\n    }\n}\n";
        return foam_header("dictionary", "controlDict") +
               "application simpleFoam;\nstartFrom latestTime;\nstartTime 0;\nstopAt endTime;\nendTime " +
               std::to_string(iterations) + ";\ndeltaT 1;\nwriteControl timeStep;\nwriteInterval " +
               std::to_string(interval) +
               ";\npurgeWrite 2;\nwriteFormat ascii;\nwritePrecision 9;\nwriteCompression off;\ntimeFormat general;\n"
               "timePrecision 6;\nrunTimeModifiable true;\n\n" +
               (watched ? functions : "");
    }

    void fields() {
        const double k = 1.5 * std::pow(o_.turbulence_intensity * o_.speed, 2),
                     nut = o_.viscosity_ratio * o_.kinematic_viscosity;
        const std::string stream = "uniform (" + digits(-o_.speed) + " 0 0)", uk = "uniform " + digits(k),
                          uo = "uniform " + digits(k / nut), un = "uniform " + digits(nut);
        const auto leave = [](const std::string& value) {
            return "type inletOutlet; inletValue " + value + "; value " + value + ";";
        };
        const std::string zero = "type zeroGradient;", no_k = "type fixedValue; value uniform 1e-14;",
                          wall_omega = "type omegaWallFunction; value uniform 1000;",
                          wall_nut = "type nutLowReWallFunction; value uniform 0;";
        field("U", "volVectorField", "[0 1 -1 0 0 0 0]", stream, "type noSlip;",
              "type fixedValue; value " + stream + ";",
              "type freestreamVelocity; freestreamValue " + stream + "; value " + stream + ";");
        field("p", "volScalarField", "[0 2 -2 0 0 0 0]", "uniform 0", zero, zero,
              "type freestreamPressure; freestreamValue uniform 0; value uniform 0;");
        field("k", "volScalarField", "[0 2 -2 0 0 0 0]", uk, no_k, no_k, leave(uk));
        field("omega", "volScalarField", "[0 0 -1 0 0 0 0]", uo, wall_omega, wall_omega, leave(uo));
        field("nut", "volScalarField", "[0 2 -1 0 0 0 0]", un, wall_nut, wall_nut,
              "type calculated; value " + un + ";");
    }

    void field(const std::string& name, const std::string& kind, const std::string& dimensions,
               const std::string& inside, const std::string& wall, const std::string& ground, const std::string& far) {
        std::string text = foam_header(kind, name) + "dimensions " + dimensions + ";\ninternalField " + inside +
                           ";\nboundaryField\n{\n";
        for (const auto& patch : made_.mesh.mesh.patches) {
            text += "    " + patch.name + " { " +
                    (patch.name == "nozzle" && o_.jet_flow > 0 ? jet(name)
                     : patch.name == "ground"                  ? ground
                     : patch.name == "farfield"                ? far
                     : patch.name == "symmetry"                ? "type symmetryPlane;"
                                                               : wall) +
                    " }\n";
        }
        put("0/" + name, text + "}\n");
    }

    /// A jet's fields: even over the opening, with the turbulence of a pipe.
    [[nodiscard]] std::string jet(const std::string& field) const {
        const double flow = o_.jet_flow / (o_.half ? 2 : 1), width = shape_.nozzle->diameter;
        if (field == "U") {
            return "type flowRateInletVelocity; volumetricFlowRate " + digits(flow) + "; value uniform (0 0 0);";
        }
        if (field == "k") {
            return "type turbulentIntensityKineticEnergyInlet; intensity 0.05; value uniform 1e-6;";
        }
        if (field == "omega") {
            return "type turbulentMixingLengthFrequencyInlet; mixingLength " + digits(0.07 * width) +
                   "; value uniform 100;";
        }
        return field == "p" ? "type zeroGradient;" : "type calculated; value uniform 0;";
    }

    static std::string run(int start) {
        const std::string time = std::to_string(start);
        return "#!/bin/sh\n"
               "# Checks the mesh that is there and runs the case. Needs OpenFOAM 1912 (Debian: apt install openfoam) "
               "and nothing sourced.\n"
               "# ./Allrun mesh: the check alone. ./Allrun solve: goes on from the last time. Alone it runs all its "
               "iterations;\n"
               "# `underbody solve` ends it when its forces have settled.\n"
               "cd \"$(dirname \"$0\")\" || exit 1\n"
               ": \"${WM_PROJECT_DIR:=/usr/share/openfoam}\"\nexport WM_PROJECT_DIR\n" +
               solver_functions() +
               "for last in [1-9]*; do :; done\n"
               "if [ \"$1\" != solve ]; then\n"
               "    [ ! -e \"$last/U\" ] || { echo \"there are results here: remove $last, or go on from it with "
               "./Allrun solve\" >&2; exit 1; }\n"
               "    echo checkMesh\n    checkMesh > log.checkMesh 2>&1 || failed checkMesh $?\n"
               "    rm -f log.simpleFoam\nfi\n"
               "[ \"$1\" != mesh ] || exit 0\n"
               "if [ ! -e \"$last/U\" ]; then\n"
               "    echo start\n    rm -rf start/" +
               time +
               "\n    ln -sfn ../constant start/constant && ln -sfn ../0 start/0 || exit 1\n"
               "    rm -f log.start\n    solver start start\n"
               "    mv start/" +
               time + " " + time +
               " && rm -f start/constant start/0\nfi\n"
               "echo simpleFoam\nsolver . simpleFoam\n";
    }

    const BodyShape& shape_;
    FlowOptions o_;
    fs::path folder_;
    core::Progress& progress_;
    BlockCase made_;
};

}  // namespace

BlockCase write_block_case(const BodyShape& shape, const FlowOptions& options, const std::filesystem::path& folder,
                           core::Progress& progress) {
    return BlockCaseWriter(shape, options, folder, progress).write();
}

}  // namespace underbody::geometry
