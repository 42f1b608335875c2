// What is wrong with the files of a batch, said once where many have it alike.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/error.h"

namespace underbody::studio {

/// Problems of several files. Those whose words differ in numbers alone are of one kind.
class BatchProblems {
public:
    void add(const std::string& file, const core::Problems& problems);

    /// One of each kind, in the order they came: the words of the first file that has it, with its name, and in how many
    /// others it is alike. `each`: all of them.
    [[nodiscard]] core::Problems gathered(bool each) const;

private:
    struct Kind {
        std::string words;  ///< without numbers
        core::Problems problems;  ///< of a file each
    };
    std::vector<Kind> kinds_;
};

}  // namespace underbody::studio
