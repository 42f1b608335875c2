#include "cases/store.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "core/error.h"

namespace underbody::cases {

namespace {

[[noreturn]] void failed(const std::string& file, const SQLite::Exception& error) {
    throw core::SystemError("store", std::string("the store of results cannot be used: ") + error.what(),
                            {file, {}, {}, {}},
                            "is the folder writable and the disk not full? --store FILE puts the store elsewhere");
}

}  // namespace

Store::Store(const std::filesystem::path& file) : file_(file.string()) {
    std::error_code error;
    if (file.has_parent_path()) {
        std::filesystem::create_directories(file.parent_path(), error);
        if (error) {
            throw core::SystemError("store", "the folder of the store cannot be made: " + error.message(),
                                    {file.parent_path().string(), {}, {}, {}},
                                    "a study in a read-only folder: --store FILE puts the store elsewhere");
        }
    }
    try {
        database_ = std::make_unique<SQLite::Database>(file_, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, 10000);
        database_->exec("PRAGMA journal_mode=WAL");
        database_->exec("PRAGMA synchronous=NORMAL");
        database_->exec(
            "CREATE TABLE IF NOT EXISTS results ("
            " key TEXT PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL, value BLOB NOT NULL,"
            " made TEXT NOT NULL DEFAULT CURRENT_TIMESTAMP, number INTEGER NOT NULL)");
        database_->exec("CREATE INDEX IF NOT EXISTS results_by_name ON results (kind, name, number)");
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
}

Store::~Store() = default;

std::optional<std::string> Store::find(const std::string& key) {
    const std::lock_guard lock(mutex_);
    try {
        SQLite::Statement query(*database_, "SELECT value FROM results WHERE key = ?");
        query.bind(1, key);
        if (query.executeStep()) {
            const SQLite::Column value = query.getColumn(0);
            return std::string(static_cast<const char*>(value.getBlob()), static_cast<std::size_t>(value.getBytes()));
        }
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
    return std::nullopt;
}

std::optional<std::string> Store::latest(const std::string& kind, const std::string& name) {
    const std::lock_guard lock(mutex_);
    try {
        SQLite::Statement query(*database_,
                                "SELECT value FROM results WHERE kind = ? AND name = ? ORDER BY number DESC LIMIT 1");
        query.bind(1, kind);
        query.bind(2, name);
        if (query.executeStep()) {
            const SQLite::Column value = query.getColumn(0);
            return std::string(static_cast<const char*>(value.getBlob()), static_cast<std::size_t>(value.getBytes()));
        }
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
    return std::nullopt;
}

void Store::put(const std::string& key, const std::string& kind, const std::string& name, const std::string& value) {
    const std::lock_guard lock(mutex_);
    try {
        SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
        SQLite::Statement insert(*database_,
                                 "INSERT OR REPLACE INTO results (key, kind, name, value, number) VALUES (?, ?, ?, ?, "
                                 "(SELECT COALESCE(MAX(number), 0) + 1 FROM results))");
        insert.bind(1, key);
        insert.bind(2, kind);
        insert.bind(3, name);
        insert.bind(4, value.data(), static_cast<int>(value.size()));
        insert.exec();
        SQLite::Statement forget(*database_,
                                 "DELETE FROM results WHERE kind = ?1 AND name = ?2 AND number NOT IN "
                                 "(SELECT number FROM results WHERE kind = ?1 AND name = ?2 ORDER BY number DESC LIMIT 4)");
        forget.bind(1, kind);
        forget.bind(2, name);
        forget.exec();
        transaction.commit();
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
}

}  // namespace underbody::cases
