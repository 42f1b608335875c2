#include "cases/file_states.h"

#include <algorithm>

#include "core/error.h"
#include "core/hash.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// Clocks of file systems tick in steps of up to two seconds: of a file that was changed less than this ago, a second
/// change may leave no trace in its stamp.
constexpr std::int64_t settled = 3'000'000'000;  // ns

/// What remains of `path` below `folder`; empty when it does not begin with it.
fs::path rest_below(const fs::path& path, const fs::path& folder) {
    auto part = path.begin();
    for (const auto& wanted : folder) {
        if (wanted.empty()) {
            continue;  // of a '/' at the end
        }
        if (part == path.end() || *part != wanted) {
            return {};
        }
        ++part;
    }
    fs::path rest;
    for (; part != path.end(); ++part) {
        rest /= *part;
    }
    return rest;
}

}  // namespace

FileStates::FileStates(fs::path folder, Store::FileHashes known, bool one_moment)
    : folder_(std::move(folder)),
      whole_folder_(fs::absolute(folder_).lexically_normal()),
      known_(std::move(known)),
      one_moment_(one_moment) {}

std::string FileStates::stored_path(const fs::path& path) const {
    const std::string& text = path.native();
    const std::string& folder = folder_.native();
    if (text.size() > folder.size() + 1 && text.starts_with(folder) && text[folder.size()] == '/') {
        return text.substr(folder.size() + 1);
    }
    fs::path rest = rest_below(path, folder_);
    if (rest.empty()) {
        rest = rest_below(fs::absolute(path).lexically_normal(), whole_folder_);
    }
    if (!rest.empty()) {
        return rest.string();
    }
    if (path == folder_ || fs::absolute(path).lexically_normal() == whole_folder_) {
        return ".";
    }
    return path.is_absolute() ? path.string()
                              : fs::absolute(path).lexically_normal().lexically_relative(whole_folder_).string();
}

fs::path FileStates::path_of(const std::string& stored) const { return folder_ / stored; }

std::string FileStates::state_of(const core::Input& input) {
    switch (input.kind) {
        case core::Input::Kind::content:
            return content_of(input.path.native(), stored_path(input.path));
        case core::Input::Kind::presence:
            return presence_of(input.path.native());
        case core::Input::Kind::names:
            break;
    }
    return names_state_of(input.path.native(), input.pattern);
}

std::string FileStates::presence_of(const std::string& path) {
    const auto kind = core::stamp_of(path.c_str()).kind;
    return kind == core::FileStamp::Kind::absent ? "absent" : kind == core::FileStamp::Kind::folder ? "folder" : "file";
}

std::string FileStates::names_state_of(const std::string& folder, std::string_view pattern) {
    Shelf& shelf = shelves_[std::hash<std::string>()(folder) % shelves_.size()];
    const std::lock_guard lock(shelf.mutex);
    const auto [place, unread] = shelf.listings.try_emplace(folder);
    Listing& listing = place->second;
    if (unread || !one_moment_) {
        const std::int64_t now = core::now_in_nanoseconds();
        const core::FileStamp stamp = core::stamp_of(folder.c_str());
        const bool kept = now - std::max(stamp.modified, stamp.changed) > settled;
        if (!kept || stamp.kind != core::FileStamp::Kind::folder || listing.stamp != stamp) {
            listing = {kept ? stamp : core::FileStamp{}, core::names_in_folder(folder, "*"), {}};
        }
    }
    if (const auto known = listing.states.find(pattern); known != listing.states.end()) {
        return known->second;
    }
    core::Hasher hasher;
    for (const auto& name : core::names_that_fit(listing.names, std::string(pattern))) {
        hasher.add(name);
    }
    return listing.states.emplace(pattern, hasher.digest()).first->second;
}

bool FileStates::still(const StoredInputs::View& input) {
    std::string path;
    if (!input.path.starts_with('/') && !folder_.empty()) {
        path.reserve(folder_.native().size() + 1 + input.path.size());
        (path += folder_.native()) += '/';
    }
    path += input.path;
    switch (input.kind) {
        case core::Input::Kind::content:
            return content_of(path, input.path) == input.state;
        case core::Input::Kind::presence:
            return presence_of(path) == input.state;
        case core::Input::Kind::names:
            break;
    }
    return names_state_of(path, input.pattern) == input.state;
}

std::string FileStates::content_of(const std::string& path, std::string_view stored) {
    const std::int64_t now = core::now_in_nanoseconds();
    const core::FileStamp stamp = core::stamp_of(path.c_str());
    if (stamp.kind == core::FileStamp::Kind::absent) {
        return "absent";
    }
    if (stamp.kind != core::FileStamp::Kind::file) {
        return "folder";
    }
    const auto stated = [&](const Store::FileHashes& hashes) {
        const auto found = hashes.find(stored);
        return found != hashes.end() && found->second.first == stamp ? &found->second.second : nullptr;
    };
    if (const std::string* known = stated(known_)) {
        return *known;
    }
    {
        const std::lock_guard lock(mutex_);
        if (const std::string* known = stated(learned_)) {
            return *known;
        }
    }
    const core::InputScope unheard(nullptr);
    std::string hash;
    try {
        hash = core::content_hash_of_file(path);
    } catch (const core::Error&) {
        return "unreadable";
    }
    const std::lock_guard lock(mutex_);
    if (now - std::max(stamp.modified, stamp.changed) > settled && core::stamp_of(path.c_str()) == stamp) {
        learned_.insert_or_assign(std::string(stored), std::pair(stamp, hash));
    }
    return hash;
}

Store::FileHashes FileStates::learned() const {
    const std::lock_guard lock(mutex_);
    return learned_;
}

}  // namespace underbody::cases
