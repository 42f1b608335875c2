#include <SQLiteCpp/SQLiteCpp.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <thread>

#include "cases/file_states.h"
#include "cases/lock.h"
#include "cases/store.h"
#include "core/error.h"
#include "core/file.h"

namespace underbody::cases {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

StoredResult result(const std::string& kind, const std::string& name, const std::string& key,
                    const std::string& state = "s") {
    StoredResult made;
    made.kind = kind;
    made.name = name;
    made.key = key;
    made.inputs = {{core::Input::Kind::content, "a file\nwith a line end 5 9", "", state},
                   {core::Input::Kind::names, "folder", "[0-9]* [!.]", "absent"},
                   {core::Input::Kind::presence, "", "", "file"}};
    made.summary = "brief";
    return made;
}

TEST(Store, GivesBackWhatWasPut) {
    const core::TemporaryFolder folder;
    const std::string bytes("a\0b\n\xff", 5);
    const StoredResult put = result("loads", "case", "k1");
    {
        Store store(folder.path() / "deep" / "s.sqlite", Store::Access::write);
        EXPECT_EQ(store.found_version(), 2);
        store.put(put, "{\"a\": 1}", bytes);
    }
    Store again(folder.path() / "deep" / "s.sqlite", Store::Access::read);
    EXPECT_FALSE(again.writable());
    const auto found = again.results("loads", "case", "k1");
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].inputs, put.inputs);
    EXPECT_EQ(found[0].identity(), put.identity());
    EXPECT_EQ(found[0].summary, "brief");
    EXPECT_EQ(again.value(found[0].id), bytes);
    EXPECT_EQ(again.made(found[0].id).value().about, "{\"a\": 1}");
    EXPECT_EQ(again.made(found[0].id).value().when.size(), std::string("2026-11-22 16:00:00").size());
    EXPECT_TRUE(again.results("loads", "case", "k2").empty());
    EXPECT_TRUE(again.results("loads", "other", "k1").empty()) << "a key belongs to its kind and name";
    EXPECT_FALSE(again.value(99).has_value());
    EXPECT_THROW(again.put(put, "{}", bytes), core::SystemError);
}

TEST(Store, OneKeyMayHaveSeveralInputs) {
    const core::TemporaryFolder folder;
    Store store(folder.path() / "s.sqlite", Store::Access::write);
    store.put(result("loads", "case", "k", "one"), "{}", "1");
    store.put(result("loads", "case", "k", "two"), "{}", "2");
    store.put(result("loads", "twin", "k", "one"), "{}", "3");
    const auto found = store.results("loads", "case", "k");
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(store.value(found[0].id), "2") << "newest first";
    EXPECT_EQ(store.value(found[1].id), "1");
    EXPECT_NE(found[0].identity(), found[1].identity());
}

TEST(Store, ForgetsOldValuesOfTheSameName) {
    const core::TemporaryFolder folder;
    Store store(folder.path() / "s.sqlite", Store::Access::write);
    for (int i = 0; i < 10; ++i) {
        store.put(result("loads", "case", "k" + std::to_string(i)), "{}", std::to_string(i));
    }
    store.put(result("loads", "other case", "k"), "{}", "x");
    EXPECT_TRUE(store.results("loads", "case", "k1").empty());
    EXPECT_EQ(store.results("loads", "case", "k2").size(), 1U);
    EXPECT_EQ(store.results().size(), 9U);
}

std::string refusal(const fs::path& file, Store::Access access) {
    try {
        const Store store(file, access);
    } catch (const core::SystemError& error) {
        return error.message();
    }
    return "opened";
}

TEST(Store, RefusesWhatIsNoStoreAndLeavesItAsItIs) {
    const core::TemporaryFolder folder;
    const fs::path file = folder.path() / "s.sqlite";
    for (const std::string& garbage : {std::string(5000, 'x'), std::string("x"), std::string(100, '\0')}) {
        core::write_file(file, garbage);
        EXPECT_THAT(refusal(file, Store::Access::write), HasSubstr("not a store of results"));
        EXPECT_THAT(refusal(file, Store::Access::read), HasSubstr("not a store of results"));
        EXPECT_EQ(core::read_file(file), garbage);
    }
    core::write_file(file, std::string("SQLite format 3\0", 16) + std::string(5000, 'x'));
    EXPECT_THAT(refusal(file, Store::Access::write), HasSubstr("damaged"));
    fs::remove(file);
    fs::create_directory(file);
    EXPECT_THAT(refusal(file, Store::Access::write), HasSubstr("folder"));
}

TEST(Store, AStoreOfALaterVersionIsRefused) {
    const core::TemporaryFolder folder;
    const fs::path file = folder.path() / "s.sqlite";
    { const Store store(file, Store::Access::write); }
    {
        SQLite::Database database(file.string(), SQLite::OPEN_READWRITE);
        database.exec("PRAGMA user_version = 3");
    }
    EXPECT_THAT(refusal(file, Store::Access::write), HasSubstr("later version"));
    EXPECT_THAT(refusal(file, Store::Access::read), HasSubstr("later version"));
}

TEST(Store, TheTableOfTheFirstVersionStays) {
    const core::TemporaryFolder folder;
    const fs::path file = folder.path() / "s.sqlite";
    {
        SQLite::Database database(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
        database.exec("PRAGMA journal_mode=WAL");
        database.exec(
            "CREATE TABLE results (key TEXT PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL, value BLOB NOT NULL,"
            " made TEXT NOT NULL DEFAULT CURRENT_TIMESTAMP, number INTEGER NOT NULL)");
        database.exec("INSERT INTO results (key, kind, name, value, number) VALUES ('k', 'loads', 'case', 'v', 1)");
    }
    {
        Store read(file, Store::Access::read);
        EXPECT_EQ(read.found_version(), 1);
        EXPECT_TRUE(read.results().empty());
        EXPECT_TRUE(read.file_hashes().empty());
    }
    {
        Store store(file, Store::Access::write);
        EXPECT_EQ(store.found_version(), 1);
        store.put(result("loads", "case", "k"), "{}", "new");
    }
    EXPECT_EQ(Store(file, Store::Access::write).found_version(), 2);
    SQLite::Database database(file.string(), SQLite::OPEN_READONLY);
    EXPECT_EQ(database.execAndGet("SELECT value FROM results").getString(), "v");
}

TEST(Store, HashesOfFilesAreRemembered) {
    const core::TemporaryFolder folder;
    Store store(folder.path() / "s.sqlite", Store::Access::write);
    const core::FileStamp stamp{core::FileStamp::Kind::file, ~std::uint64_t{0}, 7, 1, -2, 3};
    store.remember({{"a b", {stamp, "hash"}}});
    const auto hashes = store.file_hashes();
    ASSERT_EQ(hashes.size(), 1U);
    EXPECT_EQ(hashes.at("a b").first, stamp);
    EXPECT_EQ(hashes.at("a b").second, "hash");
}

TEST(FileStates, SeeAByteThatChangesWithinTheClocksTickAndWithTheOldTimePutBack) {
    const core::TemporaryFolder folder;
    const fs::path file = folder.path() / "f";
    core::write_file(file, "aaaa");
    Store::FileHashes known;
    std::string before;
    {
        FileStates states(folder.path(), {});
        before = states.state_of({core::Input::Kind::content, file, {}});
        EXPECT_TRUE(states.learned().empty()) << "a file just written may change again without another time";
        core::write_file(file, "aaab");
        EXPECT_NE(states.state_of({core::Input::Kind::content, file, {}}), before);
        core::write_file(file, "aaaa");
        EXPECT_EQ(states.state_of({core::Input::Kind::content, file, {}}), before);
    }
    // Old enough to be believed: by its stamp, then changed with size and time of modification as they were.
    const core::FileStamp stamp = core::stamp_of(file);
    known["f"] = {stamp, before};
    FileStates states(folder.path(), known);
    EXPECT_EQ(states.state_of({core::Input::Kind::content, file, {}}), before);
    struct stat status {};
    ::stat(file.c_str(), &status);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    FILE* in_place = std::fopen(file.c_str(), "r+");
    std::fputs("aaab", in_place);
    std::fclose(in_place);
    const timespec times[2] = {status.st_atim, status.st_mtim};
    ::utimensat(AT_FDCWD, file.c_str(), times, 0);
    EXPECT_EQ(core::stamp_of(file).modified, stamp.modified);
    EXPECT_NE(states.state_of({core::Input::Kind::content, file, {}}), before);
}

TEST(FileStates, PathsAreThoseOfTheStudy) {
    const FileStates states("/data/study", {});
    EXPECT_EQ(states.stored_path("/data/study/fields/a.csv"), "fields/a.csv");
    EXPECT_EQ(states.stored_path("/data/study/models/../t.csv"), "models/../t.csv") << "a link may lead elsewhere";
    EXPECT_EQ(states.stored_path("/data/study/../m.toml"), "../m.toml");
    EXPECT_EQ(states.stored_path("/data/study"), ".");
    EXPECT_EQ(states.stored_path("/data/m.toml"), "/data/m.toml") << "named absolutely by the user";
    EXPECT_EQ(states.stored_path("/data/study-2/a"), "/data/study-2/a");
    EXPECT_EQ(states.path_of("fields/a.csv"), "/data/study/fields/a.csv");
    EXPECT_EQ(states.path_of("/data/m.toml"), "/data/m.toml");
    const FileStates here(".", {});
    EXPECT_EQ(here.stored_path("fields/a.csv"), "fields/a.csv");
    EXPECT_EQ(here.stored_path(fs::absolute("fields/a.csv")), "fields/a.csv");
}

TEST(Lock, OfAResultIsHeldByOneAtATimeAndForEachResultByItselfAndLeavesNoFile) {
    const core::TemporaryFolder folder;
    const fs::path store = folder.path() / "s.sqlite";
    core::Progress progress;
    auto first = lock_of_result(store, "loads", "a", progress);
    ASSERT_TRUE(first);
    EXPECT_TRUE(lock_of_result(store, "loads", "b", progress));
    std::atomic<bool> got{false};
    std::string said;
    std::atomic<bool> waits{false};
    core::Progress told([&](double, const std::string& what) {
        said = what;
        waits = true;
    });
    std::thread other([&] {
        const auto second = lock_of_result(store, "loads", "a", told);
        got = second.has_value();
    });
    while (!waits) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_FALSE(got);
    first.reset();
    other.join();
    EXPECT_TRUE(got);
    EXPECT_THAT(said, testing::AllOf(testing::HasSubstr("waiting for process"), testing::HasSubstr("loads 'a'")));
    EXPECT_TRUE(fs::is_empty(folder.path()));
    core::Progress cancelled;
    const auto held = lock_of_result(store, "loads", "a", progress);
    cancelled.cancel();
    EXPECT_THROW((void)lock_of_result(store, "loads", "a", cancelled), core::Cancelled);
    // Where no file can be made, everybody may make it.
    EXPECT_FALSE(lock_of_result(folder.path() / std::string(300, 'x'), "k", "n", progress));
}

}  // namespace
}  // namespace underbody::cases
