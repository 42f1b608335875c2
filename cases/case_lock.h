// One process at a time in a case, also when several machines see its folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace underbody::cases {

/// A lock file that says who holds it. The kernel's lock on it (flock) goes when the last process that has it open
/// ends, however it ends; children that keep `descriptor()` open hold it too. Where a file system keeps such locks to
/// one machine, a lock of another machine counts until its file has not been touched for `stale_after`: its holder
/// calls `touch` now and then.
class CaseLock {
public:
    static constexpr int stale_after = 600;  ///< s

    /// Takes the lock; nothing when somebody else holds it. `what`: a word on what is done ("sweep"). Throws
    /// core::SystemError when the file cannot be made.
    static std::optional<CaseLock> take(const std::filesystem::path& file, const std::string& what);
    /// Who holds it: "process 4711 on host7, since 2026-01-31 12:00:00 UTC (sweep)"; nothing when nobody does.
    static std::optional<std::string> holder(const std::filesystem::path& file);

    ~CaseLock();
    CaseLock(CaseLock&& other) noexcept;
    CaseLock& operator=(CaseLock&& other) noexcept;
    CaseLock(const CaseLock&) = delete;
    CaseLock& operator=(const CaseLock&) = delete;

    void touch() const;
    [[nodiscard]] int descriptor() const { return descriptor_; }

private:
    CaseLock(std::filesystem::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}
    void release();
    std::filesystem::path file_;
    int descriptor_ = -1;
};

}  // namespace underbody::cases
