#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>

#include "core/error.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/name_pattern.h"
#include "core/parallel.h"
#include "core/random.h"

namespace underbody::core {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

std::size_t entries(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(Files, AreWrittenWhole) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "deep" / "table.csv";
    write_file(path, "first");
    write_file(path, "second");
    EXPECT_EQ(read_file(path), "second");
    EXPECT_EQ(entries(path.parent_path()), 1U) << "no temporary file may stay behind";
}

TEST(Files, AFailedWriteLeavesTheOldFileAndNothingElse) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "table.csv";
    write_file(path, "old");
    // A limit on file size stands in for a full disk: write(2) fails with EFBIG as it would with ENOSPC.
    struct rlimit old_limit {};
    ::getrlimit(RLIMIT_FSIZE, &old_limit);
    struct rlimit small = old_limit;
    small.rlim_cur = 1000;
    std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &small);
    EXPECT_THROW(write_file(path, std::string(100000, 'x')), SystemError);
    ::setrlimit(RLIMIT_FSIZE, &old_limit);
    EXPECT_EQ(read_file(path), "old");
    EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(Files, APipeOrADeviceIsWrittenToAndStaysWhatItIs) {
    const TemporaryFolder folder;
    const fs::path pipe = folder.path() / "pipe.csv";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
    write_file(pipe, "table");
    std::string heard(20, '\0');
    heard.resize(static_cast<std::size_t>(std::max<ssize_t>(::read(reader, heard.data(), heard.size()), 0)));
    ::close(reader);
    EXPECT_EQ(heard, "table");
    EXPECT_TRUE(fs::is_fifo(pipe));

    const fs::path null = folder.path() / "null.csv";  // its own, so that a failure does not take the machine's
    if (::mknod(null.c_str(), S_IFCHR | 0600, makedev(1, 3)) == 0) {
        write_file(null, "table");
        EXPECT_TRUE(fs::is_character_file(null));
    }
    EXPECT_LE(entries(folder.path()), 2U);
}

TEST(Files, APendingFileThatIsNotCommittedDisappears) {
    const TemporaryFolder folder;
    {
        PendingFile pending(folder.path() / "a.vtu");
        EXPECT_EQ(pending.path().extension(), ".vtu");
        std::ofstream(pending.path()) << "half";
    }
    EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(Files, MissingFilesAreNamedWithTheNearestOne) {
    const TemporaryFolder folder;
    write_file(folder.path() / "lift.csv", "x");
    try {
        MappedFile file(folder.path() / "litf.csv");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("litf.csv"));
        EXPECT_THAT(error.hint(), HasSubstr("'lift.csv'"));
    }
    EXPECT_THROW(MappedFile file(folder.path()), InputError);
    write_file(folder.path() / "empty", "");
    EXPECT_TRUE(MappedFile(folder.path() / "empty").bytes().empty());
}

TEST(Hash, KeysDifferWithContentAndWithItsDivision) {
    // XXH3-128 of the empty input, from the published test vectors of xxHash.
    EXPECT_EQ(content_hash(""), "99aa06d3014798d86001c324468d497f");
    EXPECT_NE(content_hash("a"), content_hash("b"));
    EXPECT_NE(Hasher().add("ab").add("c").digest(), Hasher().add("a").add("bc").digest());
    EXPECT_EQ(Hasher().add("ab").add(1.5).digest(), Hasher().add("ab").add(1.5).digest());
    EXPECT_NE(Hasher().add(0.0).digest(), Hasher().add(-0.0).digest());
}

TEST(Errors, SayPlaceMessageAndHint) {
    const InputError error("unit", "unknown unit 'mmm'", {"a.csv", 3, 2, {}}, "did you mean 'mm'?");
    EXPECT_STREQ(error.what(), "a.csv:3:2: unknown unit 'mmm'\n  hint: did you mean 'mm'?");
    EXPECT_EQ((Place{"a.cas", {}, {}, 4096}.text()), "a.cas (byte 4096)");
    EXPECT_EQ(did_you_mean("hieght", {"height", "width"}), "did you mean 'height'?");
    EXPECT_EQ(did_you_mean("zzz", {"height", "width"}), "known: height, width");
}

TEST(NamePattern, TakesConditionsFromNames) {
    const NamePattern pattern("fields/{variant}-h{gap:mm}-p{pitch:deg}.csv");
    const auto match = pattern.match("fields/ellipse_front-h1.5-p-2.csv");
    ASSERT_TRUE(match.has_value());
    EXPECT_EQ(match->texts.at(0).second, "ellipse_front");
    EXPECT_EQ(match->numbers.at(0).first, "gap");
    EXPECT_DOUBLE_EQ(match->numbers.at(0).second, 0.0015);
    EXPECT_NEAR(match->numbers.at(1).second, -0.0349065850, 1e-9);
    EXPECT_FALSE(pattern.match("fields/ellipse-h5-p0-coarse.csv").has_value());
    EXPECT_FALSE(pattern.match("fields/deeper/ellipse-h5-p0.csv").has_value());
    EXPECT_THROW(NamePattern("{gap}.csv"), UsageError);
    EXPECT_THROW(NamePattern("{gap:s}.csv"), UsageError);
    EXPECT_THROW(NamePattern("{variant.csv"), UsageError);
    EXPECT_THROW(NamePattern("{a}-{a}.csv"), UsageError);
}

TEST(NamePattern, ANumberHasAllItsDigits) {
    const auto number = [](const char* pattern, const char* name) {
        const auto match = NamePattern(pattern).match(name);
        return match ? match->numbers.at(0).second : -1;
    };
    EXPECT_DOUBLE_EQ(number("h{gap:mm}*.csv", "h10.5-coarse.csv"), 0.0105);
    EXPECT_DOUBLE_EQ(number("h{gap:mm}{mesh}.csv", "h12-fine.csv"), 0.012);
    EXPECT_DOUBLE_EQ(number("case-{gap:mm}*/*.csv", "case-5.5mm/a.csv"), 0.0055);
    EXPECT_NEAR(number("a-p{pitch:deg}*", "a-p-1.5.csv"), -1.5 * 0.017453292519943295, 1e-12);
    EXPECT_DOUBLE_EQ(number("h{gap:mm}-{mesh}", "h1e1-2"), 0.010);
    EXPECT_DOUBLE_EQ(number("h{gap:mm}5.csv", "h15.csv"), 0.001);  // the rest must fit
}

TEST(NamePattern, FindsFilesInFolders) {
    const TemporaryFolder folder;
    for (const char* name : {"x/a-h1.csv", "x/a-h2.csv", "y/b-h1.csv", "x/deep/a-h3.csv", "x/a-hx.csv"}) {
        write_file(folder.path() / name, "1");
    }
    EXPECT_EQ(NamePattern("x/{v}-h{gap:mm}.csv").files(folder.path()).size(), 2U);
    EXPECT_EQ(NamePattern("{d}/{v}-h{gap:mm}.csv").files(folder.path()).size(), 3U);
    EXPECT_EQ(NamePattern(folder.path().string() + "/x/*.csv").files().size(), 3U);
    EXPECT_TRUE(NamePattern("none/*.csv").files(folder.path()).empty());
    // From a folder that is still to be made.
    const auto beside = NamePattern("../x/{v}-h{gap:mm}.csv").files(folder.path() / "new");
    ASSERT_EQ(beside.size(), 2U);
    EXPECT_EQ(beside[0].path, (folder.path() / "x/a-h1.csv").lexically_normal());
    EXPECT_TRUE(NamePattern("x/*.csv").files(folder.path() / "new").empty());
}

TEST(NamePattern, TellsWhichFilesLackANumber) {
    const TemporaryFolder folder;
    for (const char* name : {"a-h1.csv", "a-h2-coarse.csv", "a-hO5.csv", "a-h.csv", "notes.csv", "a-h1.vtk"}) {
        write_file(folder.path() / name, "1");
    }
    const NamePattern pattern("{v}-h{gap:mm}.csv");
    EXPECT_EQ(pattern.files(folder.path()).size(), 1U);
    const auto missed = pattern.near_misses(folder.path());
    ASSERT_EQ(missed.size(), 2U);
    EXPECT_EQ(missed[0].filename(), "a-h2-coarse.csv");
    EXPECT_EQ(missed[1].filename(), "a-hO5.csv");
    EXPECT_TRUE(NamePattern("*.csv").near_misses(folder.path()).empty());
}

TEST(NamePattern, SaysWhyAFileDoesNotFit) {
    const TemporaryFolder folder;
    for (const char* name : {"a-h5mm.csv", "a-hO5.csv", "p-2.csv", "p-2fine.csv"}) {
        write_file(folder.path() / name, "1");
    }
    const NamePattern gap("{v}-h{gap:mm}.csv"), both("p{pitch:deg}{mesh}.csv");
    EXPECT_EQ(gap.why_not(folder.path() / "a-h5mm.csv", folder.path()), "'5mm' carries its unit: write {gap:mm}mm");
    EXPECT_EQ(gap.why_not(folder.path() / "a-hO5.csv", folder.path()), "'O5' is no number for {gap:mm}");
    ASSERT_EQ(both.near_misses(folder.path()).size(), 1U);
    EXPECT_EQ(both.why_not(folder.path() / "p-2.csv", folder.path()),
              "nothing is left for {mesh} behind the number -2");
    EXPECT_THROW(NamePattern("a-{sped:m/s}.csv"), UsageError);
    EXPECT_NO_THROW(NamePattern("a-{rpm:1/min}.csv"));
}

TEST(NamePattern, SortsFilesByTheNumbersInTheirNames) {
    const TemporaryFolder folder;
    for (const char* name : {"b-h1.csv", "a-h10.csv", "a-h2.csv", "a-h1.5.csv", "a-h-3.csv"}) {
        write_file(folder.path() / name, "1");
    }
    std::vector<std::string> names;
    for (const auto& found : NamePattern("{v}-h{gap:mm}.csv").files(folder.path())) {
        names.push_back(found.path.filename().string());
    }
    EXPECT_EQ(names, (std::vector<std::string>{"a-h-3.csv", "a-h1.5.csv", "a-h2.csv", "a-h10.csv", "b-h1.csv"}));
}

TEST(Parallel, CoversEveryIndexOnceAndRethrows) {
    std::vector<std::atomic<int>> seen(10001);
    parallel_blocks(seen.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            ++seen[i];
        }
    });
    for (const auto& count : seen) {
        ASSERT_EQ(count.load(), 1);
    }
    EXPECT_THROW(parallel_for(100,
                              [](std::size_t i) {
                                  if (i == 57) {
                                      throw InputError("range", "57");
                                  }
                              }),
                 InputError);
    Progress progress;
    progress.cancel();
    EXPECT_THROW(parallel_for(
                     100, [](std::size_t) {}, progress),
                 Cancelled);
}

TEST(Random, HasTheMomentsOfItsDistributionsAndIsReproducible) {
    Random random(1);
    double sum = 0;
    double squares = 0;
    double uniform_sum = 0;
    constexpr int count = 200000;
    for (int i = 0; i < count; ++i) {
        const double x = random.normal();
        sum += x;
        squares += x * x;
        uniform_sum += random.uniform();
    }
    EXPECT_NEAR(sum / count, 0, 4 / std::sqrt(count));
    EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2.0 / count));
    EXPECT_NEAR(uniform_sum / count, 0.5, 4 * std::sqrt(1.0 / 12 / count));
    EXPECT_EQ(Random(3, 5).bits(), Random(3, 5).bits());
    EXPECT_NE(Random(3, 5).bits(), Random(3, 6).bits());
}

}  // namespace
}  // namespace underbody::core
