// What there is to name in an action: things of the study and files. What is not there is refused with the nearest.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studio/desktop/state/state.h"

namespace underbody::studio::action {

/// "shape", "case", "table", "region", "measurement", "picture", "field", "export".
const std::vector<std::string>& kinds_of_things();
/// Names of the things of a kind that the state shows; of files their paths.
std::vector<std::string> names_of(const State& state, const Session& session, const std::string& kind);

/// Throws core::UsageError for an id that is not KIND/NAME, for an unknown kind, and for what is not there: each with
/// the nearest.
void need_things(const State& state, const Session& session, const std::vector<std::string>& ids);
/// Throws core::UsageError with the nearest of `known` unless it holds the name. `what`: "table".
void need_one_of(const std::string& name, const std::vector<std::string>& known, const std::string& what);

/// Absolute and normal, without a '/' at its end.
std::string whole_path(const std::filesystem::path& path);
/// The same of a file or folder. Throws core::InputError with the nearest name beside it when there is none.
std::string existing_path(const std::filesystem::path& path);

/// Throws core::UsageError with the nearest: a column that neither the loads of the cases nor shapes that vary have.
void need_column(const Session& session, const std::string& name);
/// The view of a force table: "curve AXIS", "family AXIS AXIS", "map AXIS AXIS". Throws core::UsageError for another
/// one, and for an axis that the table does not have.
void need_table_view(const std::vector<std::string>& axes, const std::string& text);
/// A declared number of a region's model. Throws core::Error: no such number (with the nearest), a value that it cannot
/// have, a model that cannot be read.
void need_parameter(const Session& session, const std::string& region, const std::string& name, double value);

}  // namespace underbody::studio::action
