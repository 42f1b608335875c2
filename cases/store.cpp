#include "cases/store.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <fstream>

#include "core/error.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"

namespace underbody::cases {

namespace fs = std::filesystem;

/// A copy of a store that cannot be opened where it lies.
class ScratchCopy {
public:
    core::TemporaryFolder folder{"underbody-store"};
};

namespace {

constexpr int version = 2;                            ///< of the tables; 0.1.0 had one table, `results`, and no number
constexpr std::size_t largest_value = 2'000'000'000;  ///< bytes: SQLite's own limit is 2^31 - 1
constexpr int patience = 20000;                       ///< ms that another process may keep the store locked

[[noreturn]] void failed(const fs::path& file, const SQLite::Exception& error) {
    throw core::SystemError("store", std::string("the store of results cannot be used: ") + error.what(),
                            {file.string(), {}, {}, {}}, "is the folder writable and the disk not full?");
}

[[noreturn]] void refuse(const fs::path& file, const std::string& what, const std::string& hint) {
    throw core::SystemError("store", what, {file.string(), {}, {}, {}}, hint);
}

/// A database begins with its name; a file of anything else is never touched.
void check_content(const fs::path& file) {
    std::error_code error;
    if (!fs::exists(file, error) || fs::file_size(file, error) == 0) {
        return;
    }
    if (fs::is_directory(file, error)) {
        refuse(file, "the store of results is a folder where a file should be", "move it away");
    }
    std::ifstream in(file, std::ios::binary);
    std::string head(16, '\0');
    in.read(head.data(), 16);
    if (!in && in.gcount() == 0) {
        refuse(file, "the store of results cannot be read", "check its permissions");
    }
    if (head != std::string("SQLite format 3\0", 16)) {
        refuse(file, "this is not a store of results (no SQLite database)",
               "move it away: all results are computed again");
    }
}

/// As long as the row is looked at.
std::string_view view_of(const SQLite::Column& column) {
    return {static_cast<const char*>(column.getBlob()), static_cast<std::size_t>(column.getBytes())};
}

std::string text_of(const SQLite::Column& column) { return std::string(view_of(column)); }

constexpr const char* columns = "id, kind, name, key, inputs, summary";

Store::Texts texts_of(SQLite::Statement& row) {
    return {row.getColumn(0).getInt64(), view_of(row.getColumn(1)), view_of(row.getColumn(2)),
            view_of(row.getColumn(3)),   view_of(row.getColumn(4)), view_of(row.getColumn(5))};
}

}  // namespace

StoredInputs::StoredInputs(std::initializer_list<StoredInput> inputs) {
    for (const auto& input : inputs) {
        push_back(input);
    }
}

StoredInputs StoredInputs::of_packed(std::string packed) {
    StoredInputs inputs;
    inputs.packed_ = std::move(packed);
    return inputs;
}

/// One line an input: kind, state, path, and the pattern of names. Paths with line ends are quoted by their lengths.
void StoredInputs::push_back(const StoredInput& input) {
    packed_ += "cpn"[static_cast<int>(input.kind)];
    ((packed_ += input.state) += ' ') += std::to_string(input.path.size());
    (packed_ += ' ') += input.path;
    packed_ += std::to_string(input.pattern.size());
    ((packed_ += ' ') += input.pattern) += '\n';
}

bool StoredInputs::next(std::string_view& text, View& input) {
    if (text.empty()) {
        return false;
    }
    const auto word = [&](char end) {
        const std::size_t at = std::min(text.find(end), text.size());
        const std::string_view result = text.substr(0, at);
        text.remove_prefix(std::min(at + 1, text.size()));
        return result;
    };
    const auto counted = [&] {
        std::size_t size = 0;
        for (const char digit : word(' ')) {
            size = 10 * size + static_cast<std::size_t>(digit - '0');
        }
        const std::string_view result = text.substr(0, size);
        text.remove_prefix(result.size());
        return result;
    };
    const char kind = text.front();
    text.remove_prefix(1);
    input.kind = kind == 'c'   ? core::Input::Kind::content
                 : kind == 'p' ? core::Input::Kind::presence
                               : core::Input::Kind::names;
    input.state = word(' ');
    input.path = counted();
    input.pattern = counted();
    word('\n');
    return true;
}

std::vector<StoredInput> StoredInputs::all() const {
    std::vector<StoredInput> inputs;
    std::string_view rest = packed_;
    for (View input; next(rest, input);) {
        inputs.push_back({input.kind, std::string(input.path), std::string(input.pattern), std::string(input.state)});
    }
    return inputs;
}

StoredResult Store::Texts::result() const {
    return {id,
            std::string(kind),
            std::string(name),
            std::string(key),
            StoredInputs::of_packed(std::string(inputs)),
            std::string(summary)};
}

std::string StoredResult::identity() const { return core::content_hash(kind + '\n' + key + '\n' + inputs.packed()); }

Store::Store(const fs::path& file, Access access) : file_(file) {
    check_content(file_);
    try {
        if (access == Access::write) {
            open_for_writing();
        } else {
            open_for_reading();
        }
        if (found_version_ == version) {
            value_of_ = std::make_unique<SQLite::Statement>(*database_, "SELECT bytes FROM result_value WHERE id = ?");
        }
    } catch (const SQLite::Exception& problem) {
        if (problem.getErrorCode() == SQLITE_NOTADB || problem.getErrorCode() == SQLITE_CORRUPT) {
            refuse(file_, std::string("the store of results is damaged: ") + problem.what(),
                   "move it away: all results are computed again");
        }
        failed(file_, problem);
    }
}

Store::~Store() = default;

void Store::open_for_writing() {
    std::error_code error;
    const bool there = fs::exists(file_, error);
    if (file_.has_parent_path()) {
        fs::create_directories(file_.parent_path(), error);
        if (error) {
            refuse(file_.parent_path(), "the folder of the store cannot be made: " + error.message(),
                   "a study in a read-only folder needs its store elsewhere");
        }
    }
    try {
        database_ =
            std::make_unique<SQLite::Database>(file_.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, patience);
        check_version();
        database_->exec("PRAGMA journal_mode=WAL");
        database_->exec("PRAGMA synchronous=NORMAL");
        make_tables();
        writable_ = sqlite3_db_readonly(database_->getHandle(), "main") == 0;
    } catch (const SQLite::Exception& problem) {
        const int code = problem.getErrorCode();
        if (!there ||
            (code != SQLITE_READONLY && code != SQLITE_CANTOPEN && code != SQLITE_PERM && code != SQLITE_IOERR)) {
            throw;
        }
        open_for_reading();  // what is known can be shown all the same
    }
}

/// SQLite wants to write beside a store in WAL mode even to read it: where it may not, it is told that nobody writes,
/// and where a killed run left its log, a copy of both is read.
void Store::open_for_reading() {
    const auto usable = [&](const std::string& name, int flags) {
        try {
            database_ = std::make_unique<SQLite::Database>(name, SQLite::OPEN_READONLY | flags, patience);
            check_version();
            return true;
        } catch (const SQLite::Exception& problem) {
            const int code = problem.getErrorCode();
            if (code != SQLITE_CANTOPEN && code != SQLITE_READONLY && code != SQLITE_PERM) {
                throw;
            }
            return false;
        }
    };
    if (usable(file_.string(), 0)) {
        return;
    }
    std::error_code error;
    fs::path log = file_;
    log += "-wal";
    if (!fs::exists(log, error) || fs::file_size(log, error) == 0) {
        std::string name = "file:";
        for (const char c : fs::absolute(file_).string()) {
            name += c == '?' || c == '#' || c == '%'
                        ? "%" + std::string(1, "0123456789abcdef"[c >> 4]) + "0123456789abcdef"[c & 15]
                        : std::string(1, c);
        }
        if (usable(name + "?immutable=1", SQLite::OPEN_URI)) {
            return;
        }
    } else {
        copy_ = std::make_unique<ScratchCopy>();
        const fs::path copied = copy_->folder.path() / "store.sqlite";
        fs::copy_file(file_, copied);
        fs::copy_file(log, copied.string() + "-wal");
        database_ = std::make_unique<SQLite::Database>(copied.string(), SQLite::OPEN_READWRITE, patience);
        check_version();
        return;
    }
    refuse(file_, "the store of results cannot be read", "check its permissions");
}

void Store::check_version() {
    found_version_ = database_->execAndGet("PRAGMA user_version").getInt();
    if (found_version_ == 0 && database_->tableExists("results")) {
        found_version_ = 1;
    }
    if (found_version_ > version) {
        refuse(file_,
               "the store of results was written by a later version of Underbody (its tables are of version " +
                   std::to_string(found_version_) + ", this program knows " + std::to_string(version) + ")",
               "use that version, or another file");
    }
}

/// Beside the table of 0.1.0, which stays as it is.
void Store::make_tables() {
    if (found_version_ == version) {
        return;
    }
    SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
    database_->exec(
        "CREATE TABLE IF NOT EXISTS result ("
        " id INTEGER PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL, key TEXT NOT NULL, inputs TEXT NOT NULL,"
        " about TEXT NOT NULL, summary TEXT NOT NULL, made TEXT NOT NULL DEFAULT CURRENT_TIMESTAMP)");
    database_->exec("CREATE INDEX IF NOT EXISTS result_by_name ON result (kind, name, id)");
    database_->exec("CREATE TABLE IF NOT EXISTS result_value (id INTEGER PRIMARY KEY, bytes BLOB NOT NULL)");
    database_->exec(
        "CREATE TABLE IF NOT EXISTS file_hash ("
        " path TEXT PRIMARY KEY, device INTEGER, inode INTEGER, size INTEGER, modified INTEGER, changed INTEGER,"
        " hash TEXT NOT NULL) WITHOUT ROWID");
    database_->exec("PRAGMA user_version = " + std::to_string(version));
    transaction.commit();
    if (found_version_ == 0) {
        found_version_ = version;
    }
}

void Store::for_each_result(const std::function<void(const Texts&)>& take) {
    const std::lock_guard lock(mutex_);
    try {
        if (!database_->tableExists("result")) {
            return;
        }
        SQLite::Statement query(*database_, std::string("SELECT ") + columns + " FROM result ORDER BY id");
        while (query.executeStep()) {
            take(texts_of(query));
        }
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
}

std::vector<StoredResult> Store::results() {
    std::vector<StoredResult> all;
    for_each_result([&](const Texts& row) { all.push_back(row.result()); });
    return all;
}

std::vector<StoredResult> Store::results(const std::string& kind, const std::string& name, const std::string& key) {
    const std::lock_guard lock(mutex_);
    std::vector<StoredResult> found;
    try {
        SQLite::Statement query(
            *database_,
            std::string("SELECT ") + columns + " FROM result WHERE kind = ? AND name = ? AND key = ? ORDER BY id DESC");
        query.bind(1, kind);
        query.bind(2, name);
        query.bind(3, key);
        while (query.executeStep()) {
            found.push_back(texts_of(query).result());
        }
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
    return found;
}

std::optional<std::string> Store::value(std::int64_t id) {
    const std::lock_guard lock(mutex_);
    try {
        if (value_of_ == nullptr) {
            value_of_ = std::make_unique<SQLite::Statement>(*database_, "SELECT bytes FROM result_value WHERE id = ?");
        }
        value_of_->reset();
        value_of_->bind(1, id);
        std::optional<std::string> value;
        if (value_of_->executeStep()) {
            value = text_of(value_of_->getColumn(0));
        }
        value_of_->reset();
        return value;
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
}

std::optional<Store::Made> Store::made(std::int64_t id) {
    const std::lock_guard lock(mutex_);
    try {
        SQLite::Statement query(*database_, "SELECT about, made FROM result WHERE id = ?");
        query.bind(1, id);
        std::optional<Made> made;
        if (query.executeStep()) {
            made = Made{text_of(query.getColumn(0)), text_of(query.getColumn(1))};
        }
        return made;
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
}

std::int64_t Store::put(const StoredResult& result, const std::string& about, const std::string& value) {
    const std::lock_guard lock(mutex_);
    if (!writable_) {
        refuse(file_,
               "the store of results cannot be written, and '" + result.name + "' is not in it or no longer true",
               "a study in a read-only folder needs its store elsewhere");
    }
    try {
        SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
        SQLite::Statement insert(
            *database_, "INSERT INTO result (kind, name, key, inputs, about, summary) VALUES (?, ?, ?, ?, ?, ?)");
        int at = 0;
        for (const auto& text : {result.kind, result.name, result.key, result.inputs.packed(), about, result.summary}) {
            insert.bind(++at, text);
        }
        insert.exec();
        const std::int64_t id = database_->getLastInsertRowid();
        SQLite::Statement bytes(*database_, "INSERT INTO result_value (id, bytes) VALUES (?, ?)");
        bytes.bind(1, id);
        if (value.size() > largest_value) {
            throw core::InputError("range",
                                   "the result is " + core::format_number(static_cast<double>(value.size()) / 1e9, 3) +
                                       " GB: the store keeps none above 2 GB",
                                   {file_.string(), {}, {}, {}});
        }
        bytes.bind(2, value.data(), static_cast<int>(value.size()));
        bytes.exec();
        const std::string old =
            "(SELECT id FROM result WHERE kind = ?1 AND name = ?2 ORDER BY id DESC LIMIT -1 OFFSET 8)";
        for (const char* table : {"result_value", "result"}) {
            SQLite::Statement forget(*database_, "DELETE FROM " + std::string(table) + " WHERE id IN " + old);
            forget.bind(1, result.kind);
            forget.bind(2, result.name);
            forget.exec();
        }
        transaction.commit();
        return id;
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
}

Store::FileHashes Store::file_hashes() {
    const std::lock_guard lock(mutex_);
    FileHashes hashes;
    try {
        if (!database_->tableExists("file_hash")) {
            return hashes;
        }
        SQLite::Statement query(*database_, "SELECT path, device, inode, size, modified, changed, hash FROM file_hash");
        while (query.executeStep()) {
            core::FileStamp stamp{core::FileStamp::Kind::file,
                                  static_cast<std::uint64_t>(query.getColumn(1).getInt64()),
                                  static_cast<std::uint64_t>(query.getColumn(2).getInt64()),
                                  query.getColumn(3).getInt64(),
                                  query.getColumn(4).getInt64(),
                                  query.getColumn(5).getInt64()};
            hashes.emplace(text_of(query.getColumn(0)), std::pair(stamp, text_of(query.getColumn(6))));
        }
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
    return hashes;
}

void Store::remember(const FileHashes& hashes) {
    const std::lock_guard lock(mutex_);
    if (!writable_ || hashes.empty()) {
        return;
    }
    try {
        SQLite::Transaction transaction(*database_, SQLite::TransactionBehavior::IMMEDIATE);
        SQLite::Statement put(*database_, "INSERT OR REPLACE INTO file_hash VALUES (?, ?, ?, ?, ?, ?, ?)");
        for (const auto& [path, known] : hashes) {
            const auto& [stamp, hash] = known;
            put.bind(1, path);
            put.bind(2, static_cast<std::int64_t>(stamp.device));
            put.bind(3, static_cast<std::int64_t>(stamp.inode));
            put.bind(4, stamp.size);
            put.bind(5, stamp.modified);
            put.bind(6, stamp.changed);
            put.bind(7, hash);
            put.exec();
            put.reset();
        }
        transaction.commit();
    } catch (const SQLite::Exception& problem) {
        failed(file_, problem);
    }
}

}  // namespace underbody::cases
