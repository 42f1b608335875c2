// One process at a time at a thing: a case that is solved, a sweep that is submitted, a result that is made.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/progress.h"

namespace underbody::cases {

/// A lock file that says who holds it; it is removed when the lock is let go. The kernel's lock on it (flock) goes when
/// the last process that has it open ends, however it ends; children that keep `descriptor()` open hold it too. Where a
/// file system keeps such locks to one machine, or knows none, a lock of another machine counts until its file has not
/// been touched for `stale_after`: its holder calls `touch` now and then.
class Lock {
public:
    static constexpr int stale_after = 600;  ///< s

    /// Whose locks count: of other machines too, or only those that this machine's kernel knows.
    enum class Among { machines, processes };
    /// Takes the lock; nothing when somebody else holds it. `what`: a word on what is done ("sweep"). Throws
    /// core::SystemError when the file cannot be made.
    static std::optional<Lock> take(const std::filesystem::path& file, const std::string& what,
                                    Among among = Among::machines);
    /// The same, waiting until the others let it go; `progress` says who they are. Throws core::Cancelled too.
    static Lock wait_for(const std::filesystem::path& file, const std::string& what, Among among,
                         core::Progress& progress);
    /// Who holds it: "process 4711 on host7, since 2026-01-31 12:00:00 UTC (sweep)"; nothing when nobody does.
    static std::optional<std::string> holder(const std::filesystem::path& file);

    ~Lock();
    Lock(Lock&& other) noexcept;
    Lock& operator=(Lock&& other) noexcept;
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

    void touch() const;
    [[nodiscard]] int descriptor() const { return descriptor_; }

private:
    Lock(std::filesystem::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}
    void release();
    std::filesystem::path file_;
    int descriptor_ = -1;
};

/// "2026-01-31 12:00:00 UTC"
std::string now_text();

/// The lock of one result of a store: no other process, and no other thread, makes it while this one does. Where no
/// lock file can be made, or the file system keeps locks to one machine, everybody may make it: it comes out the same.
std::optional<Lock> lock_of_result(const std::filesystem::path& store, const std::string& kind, const std::string& name,
                                   core::Progress& progress);

}  // namespace underbody::cases
