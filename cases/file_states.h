// In which state the files are that results rest on: by their content, read again only where it may have changed.
#pragma once

#include <array>
#include <filesystem>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "cases/store.h"
#include "core/inputs.h"

namespace underbody::cases {

/// Paths of a study and the states of what they lead to. Safe to use from many threads.
class FileStates {
public:
    /// `folder`: of the study, as the user named it. `one_moment`: all is asked at one time, such as by a list, so that
    /// a folder is read once.
    FileStates(std::filesystem::path folder, Store::FileHashes known, bool one_moment = false);

    /// Hash of the content (content), of the names (names), else "absent", "file", "folder".
    std::string state_of(const core::Input& input);
    /// True if the input is now as it was.
    bool still(const StoredInputs::View& input);

    /// How the store names a path: relative to the study, unless it was named absolutely and lies outside.
    [[nodiscard]] std::string stored_path(const std::filesystem::path& path) const;
    [[nodiscard]] std::filesystem::path path_of(const std::string& stored) const;

    /// Hashes made since, of files that had not just been changed: they may be believed the next time.
    [[nodiscard]] Store::FileHashes learned() const;

private:
    /// The names in a folder, read once as long as its stamp stays, and the states of the patterns asked for: thousands
    /// of cases lie in one folder, and each asks for what lies beside it.
    struct Listing {
        core::FileStamp stamp;
        std::vector<std::string> names;
        std::unordered_map<std::string, std::string, Store::HashOfText, std::equal_to<>> states;  ///< by pattern
    };

    // Paths as text: to take one apart costs more than to ask for its stamp.
    std::string content_of(const std::string& path, std::string_view stored);
    std::string names_state_of(const std::string& folder, std::string_view pattern);
    static std::string presence_of(const std::string& path);

    /// Folders by a hash of their path, so that threads seldom wait for one another.
    struct Shelf {
        std::mutex mutex;
        std::unordered_map<std::string, Listing> listings;
    };

    std::filesystem::path folder_;
    std::filesystem::path whole_folder_;
    const Store::FileHashes known_;
    const bool one_moment_;
    mutable std::mutex mutex_;  ///< of learned_
    Store::FileHashes learned_;
    std::array<Shelf, 16> shelves_;
};

}  // namespace underbody::cases
