// Files that the libraries of others open because a file names them: noted as inputs (core/inputs.h).
#pragma once

#include <filesystem>
#include <string>

namespace underbody::postproc {

/// The pieces of a .vtm, .pvtu and the like, and theirs.
void note_vtk_pieces(const std::filesystem::path& path);

/// The files that links in an open CGNS file lead to. `file` is the library's own number of it.
void note_cgns_links(int file, const std::filesystem::path& path);

/// A file named by `from`: beside it, or where the name says by itself.
void note_linked(const std::filesystem::path& from, const std::string& name);

}  // namespace underbody::postproc
