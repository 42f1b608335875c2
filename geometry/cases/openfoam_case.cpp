// The OpenFOAM case of a flow domain.
#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "geometry/body/body_surface.h"
#include "geometry/cases/case_files.h"
#include "geometry/cases/flow_domain.h"
#include "geometry/cases/solver_script.h"
#include "geometry/mesh/mesh_file.h"

namespace underbody::geometry {

namespace {

namespace fs = std::filesystem;

std::string point(double x, double y, double z) { return "(" + digits(x) + " " + digits(y) + " " + digits(z) + ")"; }

FlowOptions as_snappy(FlowOptions options) {
    options.mesher = CaseMesher::snappy;
    return options;
}

class Case {
public:
    Case(const SurfaceMesh& body, const FlowOptions& options, fs::path folder)
        : body_(body), o_(as_snappy(options)), d_(flow_domain(body, options)), folder_(std::move(folder)) {
        const Box made = bounding_box(body);
        length_ = made.upper.x - made.lower.x;
        cell_ = o_.cell * length_;
    }

    std::vector<fs::path> write() {
        require_empty_folder(folder_);
        put("constant/triSurface/body.stl", mesh_bytes(placed(body_, o_.placement), MeshFormat::stl_ascii));
        put("system/blockMeshDict", block_mesh());
        put("system/surfaceFeatureExtractDict",
            foam_header("dictionary", "surfaceFeatureExtractDict") +
                "body.stl\n{\n    extractionMethod extractFromSurface;\n    includedAngle 150;\n"
                "    subsetFeatures { nonManifoldEdges no; openEdges yes; }\n    writeObj no;\n}\n");
        put("system/snappyHexMeshDict", snappy());
        put("system/meshQualityDict",
            foam_header("dictionary", "meshQualityDict") +
                "maxNonOrtho 65;\nmaxBoundarySkewness 20;\nmaxInternalSkewness 4;\nmaxConcave 80;\nminVol 1e-18;\n"
                "minTetQuality 1e-15;\nminArea -1;\nminTwist 0.02;\nminDeterminant 0.001;\nminFaceWeight 0.05;\n"
                "minVolRatio 0.01;\nminTriangleTwist -1;\nnSmoothScale 4;\nerrorReduction 0.75;\n");
        put("system/controlDict", control());
        put("system/fvSchemes", schemes());
        put("system/fvSolution", solution());
        put("constant/transportProperties", foam_transport(o_.kinematic_viscosity));
        put("constant/turbulenceProperties", foam_turbulence());
        fields();
        put("Allrun", run());
        make_executable(folder_ / "Allrun");
        return files_;
    }

private:
    void put(const std::string& name, const std::string& text) {
        core::write_file(folder_ / name, text);
        files_.push_back(folder_ / name);
    }

    std::string block_mesh() const {
        const Vec3 &a = d_.box.lower, &b = d_.box.upper;
        const auto count = [this](double distance) {
            return std::to_string(static_cast<long>(std::lround(distance / cell_)));
        };
        const char* sixth = o_.half ? "symmetry { type symmetryPlane; faces ((0 1 5 4)); }"
                                    : "side_starboard { type patch; faces ((0 1 5 4)); }";
        return foam_header("dictionary", "blockMeshDict") + "scale 1;\nvertices\n(\n    " + point(a.x, a.y, a.z) +
               "\n    " + point(b.x, a.y, a.z) + "\n    " + point(b.x, b.y, a.z) + "\n    " + point(a.x, b.y, a.z) +
               "\n    " + point(a.x, a.y, b.z) + "\n    " + point(b.x, a.y, b.z) + "\n    " + point(b.x, b.y, b.z) +
               "\n    " + point(a.x, b.y, b.z) + "\n);\nblocks ( hex (0 1 2 3 4 5 6 7) (" + count(b.x - a.x) + " " +
               count(b.y - a.y) + " " + count(b.z - a.z) +
               ") simpleGrading (1 1 1) );\nedges ();\nboundary\n(\n    inlet { type patch; faces ((1 2 6 5)); }\n    "
               "outlet { type patch; faces ((0 4 7 3)); }\n"
               "    ground { type wall; faces ((0 3 2 1)); }\n    top { type patch; faces ((4 5 6 7)); }\n    side { "
               "type patch; faces ((3 7 6 2)); }\n    " +
               sixth + "\n);\nmergePatchPairs ();\n";
    }

    std::string snappy() const {
        const Box at = bounding_box(placed(body_, o_.placement));
        const double margin = 0.1 * length_;
        std::string regions, surfaces, layers;
        for (const std::string& wall : d_.walls) {
            const bool under = wall != "hull";
            const int level = under ? d_.gap_level : o_.surface_level;
            regions += "            " + wall + " { name " + wall + "; }\n";
            surfaces += "                " + wall + " { level (" +
                        std::to_string(std::max(o_.surface_level, level - 1)) + " " + std::to_string(level) +
                        "); patchInfo { type wall; } }\n";
            layers += "        " + wall + " { nSurfaceLayers " + std::to_string(o_.layers) + "; }\n";
        }
        const double low = std::max(2 * d_.clearance.smallest, o_.placement.gap);
        return foam_header("dictionary", "snappyHexMeshDict") + "castellatedMesh true;\nsnap true;\naddLayers " +
               (o_.layers > 0 ? "true" : "false") +
               ";\n\ngeometry\n{\n    body.stl\n    {\n        type triSurfaceMesh;\n        name body;\n        "
               "regions\n        {\n" +
               regions + "        }\n    }\n    gap { type searchableBox; min " + point(at.lower.x, -at.upper.y, 0) +
               "; max " + point(at.upper.x, at.upper.y, low) + "; }\n    near { type searchableBox; min " +
               point(at.lower.x - 3 * margin, -at.upper.y - margin, 0) + "; max " +
               point(at.upper.x + margin, at.upper.y + margin, at.upper.z + margin) +
               "; }\n}\n\ncastellatedMeshControls\n{\n    maxLocalCells 4000000;\n    maxGlobalCells 8000000;\n    "
               "minRefinementCells 10;\n"
               "    nCellsBetweenLevels 3;\n    features ( { file \"body.eMesh\"; level " +
               std::to_string(o_.surface_level) +
               "; } );\n    refinementSurfaces\n    {\n        body\n        {\n            level (" +
               std::to_string(o_.surface_level) + " " + std::to_string(o_.surface_level) +
               ");\n            patchInfo { type wall; }\n            regions\n            {\n" + surfaces +
               "            }\n        }\n    }\n    resolveFeatureAngle 30;\n    refinementRegions\n    {\n        "
               "gap { mode inside; levels ((1e15 " +
               std::to_string(d_.gap_level) + ")); }\n        near { mode inside; levels ((1e15 " +
               std::to_string(std::max(1, o_.surface_level - 1)) + ")); }\n    }\n    locationInMesh " +
               point(d_.box.upper.x - 0.37 * cell_, d_.box.upper.y - 0.41 * cell_, d_.box.upper.z - 0.43 * cell_) +
               ";\n    allowFreeStandingZoneFaces true;\n}\n\nsnapControls\n{\n    nSmoothPatch 3;\n    tolerance 2;\n "
               "   nSolveIter 50;\n    nRelaxIter 5;\n"
               "    nFeatureSnapIter 10;\n    implicitFeatureSnap false;\n    explicitFeatureSnap true;\n    "
               "multiRegionFeatureSnap true;\n}\n\n"
               "addLayersControls\n{\n    relativeSizes true;\n    layers\n    {\n" +
               layers +
               "    }\n    expansionRatio 1.2;\n    finalLayerThickness 0.3;\n    minThickness 0.05;\n    nGrow 0;\n   "
               " featureAngle 130;\n    nRelaxIter 3;\n"
               "    nSmoothSurfaceNormals 1;\n    nSmoothNormals 3;\n    nSmoothThickness 10;\n    "
               "maxFaceThicknessRatio 0.5;\n    maxThicknessToMedialRatio 0.3;\n"
               "    minMedianAxisAngle 90;\n    nBufferCellsNoExtrude 0;\n    nLayerIter "
               "50;\n}\n\nmeshQualityControls\n{\n    #include \"meshQualityDict\"\n}\n\nmergeTolerance 1e-6;\n";
    }

    std::string wall_list() const {
        std::string list;
        for (const std::string& wall : d_.walls) {
            list += (list.empty() ? "" : " ") + wall;
        }
        return list;
    }

    std::string control() const {
        return foam_header("dictionary", "controlDict") +
               "application simpleFoam;\nstartFrom latestTime;\nstartTime 0;\nstopAt endTime;\nendTime " +
               std::to_string(iterations_of(o_)) + ";\ndeltaT 1;\nwriteControl timeStep;\nwriteInterval " +
               std::to_string(checkpoint_interval(iterations_of(o_))) +
               ";\npurgeWrite 2;\nwriteFormat ascii;\nwritePrecision 9;\nwriteCompression off;\ntimeFormat "
               "general;\ntimePrecision 6;\nrunTimeModifiable true;\n\n"
               "functions\n{\n    // Forces in N on " +
               (o_.half ? "the half body: twice them is the whole" : "the whole body") +
               "; moments about the centre of the base.\n    forces\n    {\n        type forces;\n        libs "
               "(\"libforces.so\");\n        writeControl timeStep;\n        writeInterval 1;\n        patches (" +
               wall_list() + ");\n        rho rhoInf;\n        rhoInf " + digits(o_.density) + ";\n        CofR " +
               point(0, 0, o_.placement.gap) +
               ";\n    }\n    wallShearStress\n    {\n        type wallShearStress;\n        libs "
               "(\"libfieldFunctionObjects.so\");\n        writeControl writeTime;\n    }\n"
               "    yPlus\n    {\n        type yPlus;\n        libs (\"libfieldFunctionObjects.so\");\n        "
               "writeControl writeTime;\n    }\n}\n";
    }

    static std::string schemes() {
        return foam_header("dictionary", "fvSchemes") +
               "ddtSchemes { default steadyState; }\ngradSchemes { default cellLimited Gauss linear 1; "
               "}\ndivSchemes\n{\n    default none;\n"
               "    div(phi,U) bounded Gauss linearUpwind grad(U);\n    div(phi,k) bounded Gauss upwind;\n    "
               "div(phi,omega) bounded Gauss upwind;\n"
               "    div((nuEff*dev2(T(grad(U))))) Gauss linear;\n}\nlaplacianSchemes { default Gauss linear limited "
               "0.5; }\n"
               "interpolationSchemes { default linear; }\nsnGradSchemes { default limited 0.5; }\nwallDist { method "
               "meshWave; }\n";
    }

    static std::string solution() {
        return foam_header("dictionary", "fvSolution") +
               "solvers\n{\n    p\n    {\n        solver PCG;\n        preconditioner { preconditioner GAMG; smoother "
               "GaussSeidel; tolerance 1e-7; relTol 0.05; }\n"
               "        tolerance 1e-7;\n        relTol 0.05;\n    }\n    \"(U|k|omega)\"\n    {\n        solver "
               "smoothSolver;\n        smoother GaussSeidel;\n"
               "        tolerance 1e-9;\n        relTol 0.1;\n    }\n}\n\nSIMPLE\n{\n    nNonOrthogonalCorrectors 1;\n "
               "   consistent no;\n"
               "    residualControl { p 1e-6; U 1e-6; \"(k|omega)\" 1e-6; }\n}\n\nrelaxationFactors\n{\n    fields { p "
               "0.3; }\n"
               "    equations { U 0.6; k 0.5; omega 0.5; }\n}\n";
    }

    struct FieldText {
        std::string name, kind, dimensions, inside, inlet, outlet, wall, ground, slip;
    };

    void fields() {
        const double k = 1.5 * std::pow(o_.turbulence_intensity * o_.speed, 2),
                     omega = k / (o_.viscosity_ratio * o_.kinematic_viscosity);
        const std::string stream = "uniform (" + digits(-o_.speed) + " 0 0)", uk = "uniform " + digits(k),
                          uo = "uniform " + digits(omega);
        const std::string slip = "type slip;", zero = "type zeroGradient;";
        const auto fixed = [](const std::string& value) { return "type fixedValue; value " + value + ";"; };
        const auto leave = [](const std::string& value) {
            return "type inletOutlet; inletValue " + value + "; value " + value + ";";
        };
        // Any y+: walls switch between the viscous and the logarithmic law.
        const std::string nut = "type nutUSpaldingWallFunction; value uniform 0;",
                          kwall = "type kqRWallFunction; value " + uk + ";";
        const std::string owall = "type omegaWallFunction; value " + uo + ";";
        field({"U", "volVectorField", "[0 1 -1 0 0 0 0]", stream, fixed(stream),
               "type inletOutlet; inletValue uniform (0 0 0); value " + stream + ";", "type noSlip;", fixed(stream),
               slip});
        field({"p", "volScalarField", "[0 2 -2 0 0 0 0]", "uniform 0", zero, fixed("uniform 0"), zero, zero, slip});
        field({"k", "volScalarField", "[0 2 -2 0 0 0 0]", uk, fixed(uk), leave(uk), kwall, kwall, slip});
        field({"omega", "volScalarField", "[0 0 -1 0 0 0 0]", uo, fixed(uo), leave(uo), owall, owall, slip});
        field({"nut", "volScalarField", "[0 2 -1 0 0 0 0]", "uniform 0", "type calculated; value uniform 0;",
               "type calculated; value uniform 0;", nut, nut, "type slip;"});
    }

    void field(const FieldText& f) {
        std::string text = foam_header(f.kind, f.name) + "dimensions " + f.dimensions + ";\ninternalField " + f.inside +
                           ";\nboundaryField\n{\n";
        const auto add = [&](const std::string& patch, const std::string& condition) {
            text += "    " + patch + " { " + condition + " }\n";
        };
        add("inlet", f.inlet);
        add("outlet", f.outlet);
        add("ground", f.ground);
        add("top", f.slip);
        add("side", f.slip);
        add(o_.half ? "symmetry" : "side_starboard", o_.half ? "type symmetryPlane;" : f.slip);
        for (const std::string& wall : d_.walls) {
            add(wall, f.wall);
        }
        put("0/" + f.name, text + "}\n");
    }

    static std::string run() {
        return "#!/bin/sh\n"
               "# Makes the mesh and runs the case. Needs OpenFOAM 1912 (Debian: apt install openfoam) and nothing "
               "sourced.\n"
               "# ./Allrun mesh: the mesh alone. ./Allrun solve: goes on from the last time, on the mesh that is "
               "there.\n"
               "cd \"$(dirname \"$0\")\" || exit 1\n"
               ": \"${WM_PROJECT_DIR:=/usr/share/openfoam}\"\nexport WM_PROJECT_DIR\n" +
               solver_functions() +
               "step() {\n    echo \"$*\"\n    \"$@\" > \"log.$1\" 2>&1 || failed \"$1\" $?\n}\n"
               "if [ \"$1\" != solve ]; then\n"
               "    for time in [1-9]*; do\n"
               "        [ ! -e \"$time/U\" ] || { echo \"there are results here: remove $time, or go on from it with "
               "./Allrun solve\" "
               ">&2; exit 1; }\n"
               "    done\n"
               "    step blockMesh\n    step surfaceFeatureExtract\n    step snappyHexMesh -overwrite\n    step "
               "checkMesh\n"
               "    rm -f log.simpleFoam\nfi\n"
               "[ \"$1\" != mesh ] || exit 0\n"
               "echo simpleFoam\nsolver . simpleFoam\n";
    }

    const SurfaceMesh& body_;
    FlowOptions o_;
    FlowDomain d_;
    fs::path folder_;
    double length_ = 0, cell_ = 0;
    std::vector<fs::path> files_;
};

}  // namespace

std::vector<std::filesystem::path> write_openfoam_case(const SurfaceMesh& body, const FlowOptions& options,
                                                       const std::filesystem::path& folder) {
    return Case(body, options, folder).write();
}

std::vector<std::filesystem::path> write_openfoam_case(const BodyShape& shape, const FlowOptions& options,
                                                       const std::filesystem::path& folder, core::Progress& progress) {
    if (tail_plate(shape) != nullptr && options.mesher != CaseMesher::blocks) {
        throw core::InputError("mesh", "the body '" + shape.name + "' has a tail plate, which blocks alone can mesh",
                               {}, "the mesher blocks, or a shape without [tail_plate]");
    }
    return options.mesher == CaseMesher::blocks
               ? write_block_case(shape, options, folder, progress).files
               : write_openfoam_case(make_surface(shape, {}, progress), options, folder);
}

}  // namespace underbody::geometry
