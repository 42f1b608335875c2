// What is wrong with the files of a batch, said once where many have it alike.
#pragma once

#include <string>
#include <unordered_set>
#include <vector>

#include "core/error.h"

namespace underbody::core {

/// Problems of several files. Those whose words differ in numbers alone are of one kind.
class BatchProblems {
public:
    /// `each`: every problem is wanted; else, for ten thousand files, what one of a kind says is all that is kept.
    explicit BatchProblems(bool each) : each_(each) {}
    void add(const std::string& file, const Problems& problems);

    /// One of each kind, in the order they came: the words of the first file that has it, with its name, and in how
    /// many others it is alike; where each is wanted, all of them.
    [[nodiscard]] Problems gathered() const;

private:
    struct Kind {
        std::string words;  ///< without numbers
        std::string last;   ///< as it was said last
        Problems problems;  ///< the first, or each
        std::unordered_set<std::string> files;
    };
    bool each_;
    std::vector<Kind> kinds_;
};

}  // namespace underbody::core
