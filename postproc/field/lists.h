// What this room knows by name, for people who choose: CFD files that are read, views that are drawn.
#pragma once

#include <string>
#include <vector>

namespace underbody::postproc {

struct CfdFormat {
    std::string name;
    std::string files;  ///< what its files are called
};
/// In the order in which importers are asked.
const std::vector<CfdFormat>& cfd_formats();

/// A kind of view, whatever the field: `possible_views` says which of them a field allows.
struct ViewKind {
    std::string name;
    std::string unit;  ///< SI, of what its colours show
    std::string meaning;
};
std::vector<ViewKind> view_kinds();

}  // namespace underbody::postproc
