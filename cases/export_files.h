// Files of results beside the report.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace underbody::cases {

/// The name of a table as identifier and file; a long one is cut, with a hash of the whole behind it.
std::string export_name(std::string table);

/// "lift.h": the file of an export of a [[table]]; "lift_simulink.mat" where another format ends alike. Throws
/// core::InputError for an unknown format.
std::string export_file(const std::string& table, const std::string& format);

/// The files of a stored export by name: a line of JSON ([{"file", "size"}]), then their bytes. Valid as long as
/// `value`.
std::vector<std::pair<std::string, std::string_view>> exported_files(std::string_view value);

}  // namespace underbody::cases
