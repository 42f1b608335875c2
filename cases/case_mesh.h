// How the mesh of an OpenFOAM case is made: the keys that [sweep] and [[design.fidelity]] share.
#pragma once

#include <string>
#include <vector>

#include "core/file_format.h"
#include "core/toml.h"
#include "geometry/cases/flow_domain.h"

namespace underbody::cases {

struct CaseMesh {
    std::string mesher = "blocks";   ///< or "snappy"
    std::string density = "medium";  ///< of the blocks: draft, coarse, medium, fine
    double cell = 0.125;             ///< of the background mesh, in body lengths
    int surface_level = 3;           ///< halvings of the cell at the body
    int layers = 3;
    int iterations = 0;  ///< at most; 0: as the mesher needs

    void put_into(geometry::FlowOptions& flow) const;
};

/// `usual`: what holds where a key is not set. Throws core::InputError with the place: keys of one mesher beside
/// another, an unknown mesher or density.
CaseMesh read_case_mesh(const core::TomlTable& table, CaseMesh usual = {});
/// The keys, for the format of a file.
std::vector<core::FileKey> case_mesh_keys(const std::string& usual_density);

}  // namespace underbody::cases
