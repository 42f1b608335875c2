// The study's store: what was computed and from what, in one SQLite file in WAL mode.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/inputs.h"

namespace SQLite {
class Database;
class Statement;
}  // namespace SQLite

namespace underbody::cases {

/// A thing on disk that a result rests on, as it was when the result was made. Paths are relative to the study where
/// they can be.
struct StoredInput {
    core::Input::Kind kind = core::Input::Kind::content;
    std::string path;
    std::string pattern;
    std::string state;  ///< hash of the content or of the names; "absent", "file", "folder"
    bool operator==(const StoredInput&) const = default;
};

/// The inputs of a result as one text, which is how the store keeps them: a list of ten thousand results looks at each
/// input where it stands and takes none apart.
class StoredInputs {
public:
    struct View {
        core::Input::Kind kind = core::Input::Kind::content;
        std::string_view path;
        std::string_view pattern;
        std::string_view state;
        View() = default;
        View(const StoredInput& input)  // NOLINT: a view of an input is one
            : kind(input.kind), path(input.path), pattern(input.pattern), state(input.state) {}
    };

    StoredInputs() = default;
    StoredInputs(std::initializer_list<StoredInput> inputs);
    static StoredInputs of_packed(std::string packed);
    void push_back(const StoredInput& input);
    [[nodiscard]] std::vector<StoredInput> all() const;
    /// True if `holds` is true of each, in the order they stand in.
    template <class Holds>
    [[nodiscard]] static bool all_of(std::string_view packed, const Holds& holds) {
        for (View input; next(packed, input);) {
            if (!holds(input)) {
                return false;
            }
        }
        return true;
    }
    [[nodiscard]] const std::string& packed() const { return packed_; }
    bool operator==(const StoredInputs&) const = default;

private:
    /// Takes the first input off the text; false: there is none.
    static bool next(std::string_view& text, View& input);
    std::string packed_;
};

/// One result but for its value.
struct StoredResult {
    std::int64_t id = 0;
    std::string kind;
    std::string name;
    std::string key;  ///< digest over options, conditions and code
    StoredInputs inputs;
    std::string summary;  ///< what a list of many results shows; may be empty

    /// Digest over kind, key and inputs: another one, another result.
    [[nodiscard]] std::string identity() const;
};

/// Safe to use from many threads and many processes. A killed run leaves the last committed result.
class Store {
public:
    enum class Access {
        write,  ///< opened or made; where that cannot be, and there is a store, as `read`
        read,   ///< no result is written; on a read-only disk, nothing at all
    };
    /// Throws core::SystemError: a folder that cannot be written and no store, a file that is no store, a store of a
    /// later version of the program.
    Store(const std::filesystem::path& file, Access access);
    ~Store();
    Store(const Store&) = delete;
    Store& operator=(const Store&) = delete;

    [[nodiscard]] bool writable() const { return writable_; }
    /// Of the file before it was opened: 0 none, 1 made by Underbody 0.1.0, 2 this one.
    [[nodiscard]] int found_version() const { return found_version_; }
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }

    /// The columns of a result, as long as it is looked at.
    struct Texts {
        std::int64_t id = 0;
        std::string_view kind;
        std::string_view name;
        std::string_view key;
        std::string_view inputs;  ///< packed
        std::string_view summary;
        [[nodiscard]] StoredResult result() const;
    };
    /// All results, oldest first.
    void for_each_result(const std::function<void(const Texts&)>& take);
    [[nodiscard]] std::vector<StoredResult> results();
    /// Those of one kind, name and key, newest first.
    [[nodiscard]] std::vector<StoredResult> results(const std::string& kind, const std::string& name,
                                                    const std::string& key);
    /// The value of a result; nothing when it has been forgotten meanwhile.
    [[nodiscard]] std::optional<std::string> value(std::int64_t id);
    /// How a result was made.
    struct Made {
        std::string about;  ///< JSON: what the key was made of, and of which other results
        std::string when;   ///< UTC
    };
    [[nodiscard]] std::optional<Made> made(std::int64_t id);
    /// In one transaction: puts the result and forgets all but the last eight of its kind and name. Gives its id.
    std::int64_t put(const StoredResult& result, const std::string& about, const std::string& value);

    struct HashOfText {
        using is_transparent = void;
        std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>()(text); }
    };
    /// Hashes of files by path: the stamp they had and the hash.
    using FileHashes =
        std::unordered_map<std::string, std::pair<core::FileStamp, std::string>, HashOfText, std::equal_to<>>;
    [[nodiscard]] FileHashes file_hashes();
    /// In one transaction. Does nothing in a store that is only read.
    void remember(const FileHashes& hashes);

private:
    void open_for_writing();
    void open_for_reading();
    void check_version();
    void make_tables();

    std::mutex mutex_;
    std::filesystem::path file_;
    std::unique_ptr<SQLite::Database> database_;
    std::unique_ptr<class ScratchCopy> copy_;
    std::unique_ptr<SQLite::Statement> value_of_;
    bool writable_ = false;
    int found_version_ = 0;
};

}  // namespace underbody::cases
