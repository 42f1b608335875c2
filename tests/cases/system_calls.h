// The test program stands between its libraries and the system: it sees which files they open, and makes writes fail.
#pragma once

#include <set>
#include <string>

namespace underbody::test {

/// While it lives, files below `folder` that anything in this process opens for reading are remembered.
class OpenedFiles {
public:
    explicit OpenedFiles(const std::string& folder);
    ~OpenedFiles();
    OpenedFiles(const OpenedFiles&) = delete;
    OpenedFiles& operator=(const OpenedFiles&) = delete;
    [[nodiscard]] std::set<std::string> paths() const;
};

/// While it lives, the n-th call that writes, syncs, renames or makes a file fails as on a full disk, and all after it.
class FailingWrites {
public:
    explicit FailingWrites(long at);
    ~FailingWrites();
    FailingWrites(const FailingWrites&) = delete;
    FailingWrites& operator=(const FailingWrites&) = delete;
    /// Calls so far.
    [[nodiscard]] static long calls();
};

}  // namespace underbody::test
