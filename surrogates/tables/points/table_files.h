// Files that hold a table, by their endings.
#pragma once

#include <string>
#include <vector>

namespace underbody::tables {

struct TableFile {
    std::string format;      ///< "c", "csv", ...: the word of an export
    std::string ending;      ///< ".h"
    bool read_back = false;  ///< read_points takes it
};
const std::vector<TableFile>& table_files();
/// Ending of a format of table_files().
const std::string& table_ending(const std::string& format);

}  // namespace underbody::tables
