// The study's store: results by the content they came from, in one SQLite file in WAL mode.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace SQLite {
class Database;
}

namespace underbody::cases {

/// Safe to use from many threads and many processes. A killed run leaves the last committed result.
class Store {
public:
    /// Opens or makes the file. Throws core::SystemError (read-only folder, no store) with a hint.
    explicit Store(const std::filesystem::path& file);
    ~Store();
    Store(const Store&) = delete;
    Store& operator=(const Store&) = delete;

    /// The value made for exactly this key, if there is one.
    [[nodiscard]] std::optional<std::string> find(const std::string& key);
    /// The last value put for this kind and name, whatever its key.
    [[nodiscard]] std::optional<std::string> latest(const std::string& kind, const std::string& name);
    /// In one transaction: puts the value and forgets all but the last four values of the same kind and name.
    void put(const std::string& key, const std::string& kind, const std::string& name, const std::string& value);

private:
    std::mutex mutex_;
    std::unique_ptr<SQLite::Database> database_;
    std::string file_;
};

}  // namespace underbody::cases
