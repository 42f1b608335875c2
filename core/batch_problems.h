// What is wrong with the files of a batch, said once where many have it alike.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/error.h"

namespace underbody::core {

/// Problems of several files. Those whose words differ in numbers alone are of one kind.
class BatchProblems {
public:
    void add(const std::string& file, const Problems& problems);

    /// One of each kind, in the order they came: the words of the first file that has it, with its name, and in how
    /// many others it is alike. `each`: all of them.
    [[nodiscard]] Problems gathered(bool each) const;

private:
    struct Kind {
        std::string words;  ///< without numbers
        Problems problems;  ///< of a file each
    };
    std::vector<Kind> kinds_;
};

}  // namespace underbody::core
