// Who makes a result, when several processes want it at once.
#pragma once

#include <filesystem>
#include <string>

#include "core/progress.h"

namespace underbody::cases {

/// While it lives, no other process (and no other claim of this one) makes the result of this name. A killed process
/// leaves no claim behind: the system lets it go. Where the file system knows no locks, everybody may make it.
class Claim {
public:
    /// Waits until the result is free. Throws core::Cancelled.
    Claim(const std::filesystem::path& store, const std::string& kind, const std::string& name,
          core::Progress& progress);
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

    /// Somebody else had it when it was asked for.
    [[nodiscard]] bool waited() const { return waited_; }

private:
    int file_ = -1;
    bool waited_ = false;
};

}  // namespace underbody::cases
