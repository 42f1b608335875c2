#include "surrogates/tables/points/table_files.h"

#include <algorithm>
#include <stdexcept>

namespace underbody::tables {

const std::vector<TableFile>& table_files() {
    static const std::vector<TableFile> files = {
        {"c", ".h"},        {"csv", ".csv", true}, {"json", ".json", true}, {"mat", ".mat"},
        {"jsbsim", ".xml"}, {"simulink", ".mat"},  {"modelica", ".combi"},  {"fmu", ".fmu"},
    };
    return files;
}

const std::string& table_ending(const std::string& format) {
    const auto at = std::find_if(table_files().begin(), table_files().end(),
                                 [&](const TableFile& file) { return file.format == format; });
    if (at == table_files().end()) {
        throw std::logic_error("no ending is known of tables as " + format);
    }
    return at->ending;
}

}  // namespace underbody::tables
