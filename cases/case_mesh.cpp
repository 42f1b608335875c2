#include "cases/case_mesh.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace underbody::cases {

void CaseMesh::put_into(geometry::FlowOptions& flow) const {
    const auto index_in = [](const std::vector<std::string>& names, const std::string& name) {
        return std::find(names.begin(), names.end(), name) - names.begin();
    };
    flow.mesher = static_cast<geometry::CaseMesher>(index_in(geometry::mesher_names(), mesher));
    flow.mesh_density = static_cast<geometry::MeshDensity>(index_in(geometry::density_names(), density));
    flow.cell = cell;
    flow.surface_level = surface_level;
    flow.layers = layers;
    flow.iterations = iterations;
}

CaseMesh read_case_mesh(const core::TomlTable& table, CaseMesh usual) {
    CaseMesh mesh = std::move(usual);
    // A study that sets the cells of snappyHexMesh has it, as it had when there was no other.
    const bool of_snappy = table.has("cell") || table.has("surface_level") || table.has("layers");
    mesh.mesher = table.choice("mesher", geometry::mesher_names(), of_snappy ? "snappy" : mesh.mesher);
    if (of_snappy && mesh.mesher == "blocks") {
        throw core::InputError("choice", "cell, surface_level and layers are snappyHexMesh's: blocks have none",
                               table.place("mesher"),
                               "mesher = \"snappy\", or mesh_density = \"fine\" and none of them");
    }
    if (table.has("mesh_density") && mesh.mesher == "snappy") {
        throw core::InputError("choice", "mesh_density is that of the blocks: snappyHexMesh has cell and surface_level",
                               table.place("mesh_density"), "mesher = \"blocks\", or cell = 0.125");
    }
    mesh.density = table.choice("mesh_density", geometry::density_names(), mesh.density);
    mesh.cell = table.quantity_or("cell", "1", mesh.cell);
    mesh.surface_level = static_cast<int>(table.integer_or("surface_level", mesh.surface_level));
    mesh.layers = static_cast<int>(table.integer_or("layers", mesh.layers));
    mesh.iterations = static_cast<int>(table.integer_or("iterations", mesh.iterations));
    const auto at_least = [&](const char* key, double value, double least) {
        if (table.has(key) && !(value >= least)) {
            throw core::InputError("range", table.path_of(key) + " is " + core::format_number(value), table.place(key),
                                   "the nearest allowed value: " + core::format_number(least));
        }
    };
    at_least("cell", mesh.cell, 0.01);
    at_least("surface_level", mesh.surface_level, 0);
    at_least("layers", mesh.layers, 0);
    at_least("iterations", mesh.iterations, 0);
    return mesh;
}

std::vector<core::FileKey> case_mesh_keys(const std::string& usual_density) {
    const CaseMesh usual;
    std::string densities;
    for (const auto& name : geometry::density_names()) {
        densities += (densities.empty() ? "" : ", ") + name;
    }
    return {{"mesher", "blocks, snappy", "\"blocks\"", "blocks; snappy where cell, surface_level or layers are set",
             "blocks of hexahedra with many cells in any gap, or snappyHexMesh"},
            {"mesh_density", densities, "\"medium\"", usual_density, "of the blocks"},
            {"cell", "1", "0.125", core::format_number(usual.cell),
             "cell of snappyHexMesh's background mesh, in body lengths"},
            {"surface_level", "whole number", "3", std::to_string(usual.surface_level),
             "halvings of that cell at the body"},
            {"layers", "whole number", "3", std::to_string(usual.layers), "layers of cells on the walls"},
            {"iterations", "whole number", "400", "0 (blocks 800, snappy 400)",
             "of the solver at most; with blocks it ends when the loads have settled"}};
}

}  // namespace underbody::cases
