// Results and meshes in two files: which belongs to which, by name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace underbody::postproc {

/// The file in the same folder whose name is that of `path` with one of its `endings` replaced by one of `others`;
/// with `earlier` also without trailing numbers, as results of a series ("run-1-00010.dat") belong to the case they
/// began with
/// ("run.cas"); a case never takes the results of another. Empty: there is none.
std::filesystem::path partner_by_name(const std::filesystem::path& path, const std::vector<std::string>& endings,
                                      const std::vector<std::string>& others, bool earlier);

}  // namespace underbody::postproc
