// What a file or folder is that no importer reads.
#pragma once

#include <filesystem>
#include <string>

namespace underbody::postproc {

/// What it is and what to do instead, for the hint of an error: "a mesh of Gmsh: save it as CGNS"; empty when nothing
/// is known about it.
std::string what_it_is(const std::filesystem::path& path);

/// Is it text whose lines end in carriage returns alone, as those of Macs once did? Who reads it by lines sees one.
bool has_lone_returns(const std::filesystem::path& path);

}  // namespace underbody::postproc
