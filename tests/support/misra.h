// MISRA C:2012 in generated C, as cppcheck's addon finds it.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "core/file.h"

namespace underbody::test {

struct MisraFindings {
    std::set<std::string> rules;     ///< "8.9", ...: all that were broken
    std::set<std::string> required;  ///< those that are not merely advisory
    std::string text;                ///< what cppcheck said
};

/// Of NAME.c in a folder and of what it includes from there. `cppcheck` and `python3` have to be there.
inline MisraFindings misra_findings(const std::filesystem::path& folder, const std::string& name) {
    static const std::set<std::string> advisory = {"2.3",  "2.4",  "2.5",  "2.6",  "2.7",  "4.2",  "5.9",  "8.7",
                                                   "8.9",  "8.11", "8.13", "10.5", "11.4", "11.5", "12.1", "12.3",
                                                   "12.4", "13.3", "13.4", "15.1", "15.4", "15.5", "17.5", "17.8",
                                                   "18.4", "18.5", "19.2", "20.1", "20.5", "21.12"};
    MisraFindings found;
    const std::string command =
        "cd '" + folder.string() + "' && cppcheck --std=c99 --addon=misra -q " + name + ".c > misra.txt 2>&1";
    if (std::system(command.c_str()) != 0) {
        found.required.insert("cppcheck did not run");
    }
    found.text = core::read_file(folder / "misra.txt");
    for (std::size_t at = 0; (at = found.text.find("[misra-c2012-", at)) != std::string::npos;) {
        at += 13;
        const std::string rule = found.text.substr(at, found.text.find(']', at) - at);
        found.rules.insert(rule);
        if (!advisory.contains(rule)) {
            found.required.insert(rule);
        }
    }
    return found;
}

}  // namespace underbody::test
