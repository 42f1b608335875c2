// A program that runs commands inside its own process (the Python module) and takes what a terminal would get.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"
#include "geometry/mesh/surface_mesh.h"
#include "postproc/field/field.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::studio {

struct Caller {
    // What the caller gives.
    std::map<std::string, postproc::Field> fields;                    ///< read already: path -> field
    std::map<std::string, std::vector<tables::ForceTable>> fitted{};  ///< fitted already: path -> its forces
    std::string program;  ///< path of `underbody`, for jobs that call it later; empty: there is none

    // What it takes.
    enum class Level { warning, info, detail };
    std::string document;  ///< the JSON that --json prints
    std::vector<std::pair<Level, std::string>> remarks;
    std::optional<geometry::SurfaceMesh> surface;             ///< of `body`, where it was placed
    std::vector<std::pair<std::string, core::Table>> tables;  ///< what --out or --table would write
    std::string error;                                        ///< the whole sentence; empty when all went well
    std::string error_class;                                  ///< "InputError", "UsageError", "SystemError", ...
};

}  // namespace underbody::studio
