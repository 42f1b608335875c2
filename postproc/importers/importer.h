// One importer a format. A new format is one file here and one line in registry.cpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "postproc/field/field.h"

namespace underbody::postproc {

struct Importer {
    std::string format;  ///< "CFD-Post CSV"
    /// True if the first bytes (at most 64 KiB) and the name are of this format. Content decides; the ending is a hint.
    bool (*recognises)(std::string_view head, const std::filesystem::path& path);
    Field (*read)(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress);
};

/// All importers, most specific first.
const std::vector<Importer>& importers();

/// The one that recognises the file (or folder); nullptr when none does.
const Importer* importer_for(const std::filesystem::path& path);

}  // namespace underbody::postproc
