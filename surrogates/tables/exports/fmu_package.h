// An FMU as a file: its description, its sources, and what the compilers of this machine make of them.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace underbody::tables {

/// File name and text of a source; the first is the one that is compiled.
using FmuSources = std::vector<std::pair<std::string, std::string>>;

/// A GUID out of what the FMU computes: the same text, the same GUID.
std::string fmu_guid(const std::string& content);

/// modelDescription.xml, sources/, and binaries/linux64 and win64 where a compiler is there (cc,
/// x86_64-w64-mingw32-gcc; `-std=c99`, no library but that of C). `name`: the model identifier. The same text and
/// compiler give the same bytes. What could not be compiled is said in `remarks`.
void write_fmu(const std::filesystem::path& path, const std::string& name, const std::string& description,
               const FmuSources& sources, core::Problems& remarks);

}  // namespace underbody::tables
