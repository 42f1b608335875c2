// A table that one room makes for the report of another.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace underbody::core {

struct ReportTable {
    std::string title;
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
    std::string note;                                        ///< below the table; may be empty
    std::vector<std::pair<std::string, std::string>> links;  ///< target beside the page, text
};

}  // namespace underbody::core
