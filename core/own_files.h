// Files of others are not overwritten: which files this program wrote, and the refusal to replace any other.
//
// A file written whole (`write_file`, `PendingFile`) carries an extended attribute `user.underbody` with its size and
// time of change; a file that lacks it, or was changed since, is somebody else's (but for a report whose head says that
// this program made it: copies lose their attributes). Where the file system keeps no attributes nothing can be known
// of text files; pictures are then told by their first bytes.
#pragma once

#include <filesystem>

namespace underbody::core {

/// True when nothing of anybody else would be lost by replacing the file: it is missing or empty, is no regular file,
/// or this program wrote it and nobody changed it since.
bool may_replace(const std::filesystem::path& path);

/// From now on writing over a file of somebody else throws InputError (kind "exists"). Off at the start: a program that
/// people drive by hand turns it on.
void protect_other_files(bool on);

/// Throws InputError (kind "exists") when the protection is on and the file is somebody else's. Writers call it; called
/// before a long calculation it saves the wait.
void refuse_other_file(const std::filesystem::path& path);

/// Takes the protection off while it lives, for files that are meant to be changed (a study that gets a case).
class ReplacingAllowed {
public:
    ReplacingAllowed();
    ~ReplacingAllowed();
    ReplacingAllowed(const ReplacingAllowed&) = delete;
    ReplacingAllowed& operator=(const ReplacingAllowed&) = delete;

private:
    bool before_;
};

/// Marks the open file as written by this program.
void mark_as_own(int descriptor);

}  // namespace underbody::core
