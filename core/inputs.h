// What a piece of work reads: the files, the places where it looks for one, the folders whose names it goes through.
// A result that is kept knows by this list whether it is still true.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace underbody::core {

/// What the file system says of a path without reading it. Two equal stamps: the same file, not changed in between
/// (unless within the resolution of its clock).
struct FileStamp {
    enum class Kind { absent, file, folder, other };
    Kind kind = Kind::absent;
    std::uint64_t device = 0;
    std::uint64_t inode = 0;
    std::int64_t size = 0;      ///< bytes
    std::int64_t modified = 0;  ///< ns since 1970, of the content
    std::int64_t changed = 0;   ///< ns since 1970, of the content or of what is stated about it; no user sets it

    bool operator==(const FileStamp&) const = default;
};
/// Links are followed. What cannot be looked at is absent.
FileStamp stamp_of(const std::filesystem::path& path);
FileStamp stamp_of(const char* path);
/// ns since 1970.
std::int64_t now_in_nanoseconds();

/// One thing on disk that a result rests on.
struct Input {
    enum class Kind {
        content,   ///< the bytes of a file, or that there is none
        presence,  ///< whether there is a file, a folder or nothing
        names,     ///< the names in a folder that fit `pattern`
    };
    Kind kind = Kind::content;
    std::filesystem::path path;  ///< as it was named
    std::string pattern;         ///< of `names`: * ? [ ] as in a shell; a leading dot fits too
};

/// Names in the folder that fit the pattern, sorted, folders with '/' behind; empty when there is no such folder.
std::vector<std::string> names_in_folder(const std::filesystem::path& folder, const std::string& pattern);
/// Those that fit, of names that names_in_folder gave: looks only among those with the pattern's fixed beginning.
std::vector<std::string> names_that_fit(const std::vector<std::string>& sorted, const std::string& pattern);

/// The inputs of one piece of work, each once, with the state in which it met them. Safe to use from many threads.
class InputRecord {
public:
    /// What to remember of an input. It is asked before the work reads it, so that a file that changes meanwhile
    /// differs from what is remembered.
    using StateOf = std::function<std::string(const Input&)>;
    struct Entry {
        Input input;
        std::string state;
    };
    explicit InputRecord(StateOf state_of) : state_of_(std::move(state_of)) {}
    void add(Input input);
    void add(const std::vector<Entry>& entries);
    /// Sorted by path. The presence of a file whose content is an input too is left out.
    [[nodiscard]] std::vector<Entry> entries() const;

private:
    StateOf state_of_;
    mutable std::mutex mutex_;
    std::map<std::pair<std::string, std::string>, Entry> entries_;  ///< by path, kind and pattern
};

/// While it lives, what this thread and the parallel loops that it starts read goes into the record too. Scopes nest:
/// an outer record holds what the inner ones hold.
class RecordInputs {
public:
    explicit RecordInputs(InputRecord& record);
    /// The other way round: what lies in this folder is the work's own scratch, and goes into no record.
    explicit RecordInputs(std::filesystem::path own_folder);
    ~RecordInputs();
    RecordInputs(const RecordInputs&) = delete;
    RecordInputs& operator=(const RecordInputs&) = delete;

private:
    InputRecord* record_ = nullptr;
    std::filesystem::path own_folder_;
    const RecordInputs* outer_;
    friend void note(const Input& input);
    friend void note(const std::vector<InputRecord::Entry>& entries);
};

/// For every reader: call before the file is opened. Nothing happens where nobody records.
void note_content(const std::filesystem::path& path);
/// Before looking whether a file or folder is there.
void note_presence(const std::filesystem::path& path);
/// Before going through the names in a folder.
void note_names(const std::filesystem::path& folder, const std::string& pattern);
void note(const Input& input);
/// What something that is used again had read when it was made.
void note(const std::vector<InputRecord::Entry>& entries);

/// For what starts threads: takes the scopes of one thread over to another.
class InputScope {
public:
    /// Of the calling thread.
    static const RecordInputs* current();
    explicit InputScope(const RecordInputs* scope);
    ~InputScope();
    InputScope(const InputScope&) = delete;
    InputScope& operator=(const InputScope&) = delete;

private:
    const RecordInputs* before_;
};

}  // namespace underbody::core
