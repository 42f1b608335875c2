// A short fuzzing of every importer within the normal tests: the small files of tests/data, changed in ways that
// repeat.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>

#include "core/file.h"
#include "core/random.h"
#include "postproc/field.h"
#include "tests/support/support.h"

namespace underbody {

namespace {

/// One to four changes: a byte, a number, a piece cut out, doubled or put elsewhere, the rest cut off.
std::string changed(std::string bytes, core::Random& random) {
    const auto below = [&](std::size_t limit) {
        return limit == 0 ? std::size_t{0}
                          : static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(limit)) % limit;
    };
    for (std::size_t changes = 1 + below(4); changes > 0 && bytes.size() > 8; --changes) {
        const std::size_t at = below(bytes.size());
        const std::size_t length = 1 + below(std::min<std::size_t>(64, bytes.size() - at));
        switch (below(6)) {
            case 0:
                bytes[at] = static_cast<char>(below(256));
                break;
            case 1:
                bytes[at] = "0123456789abcdef()-. \n\""[below(22)];
                break;
            case 2:
                bytes.erase(at, length);
                break;
            case 3:
                bytes.insert(below(bytes.size()), bytes.substr(at, length));
                break;
            case 4:
                bytes.replace(at, std::min<std::size_t>(4, bytes.size() - at),
                              below(2) == 0 ? "\xff\xff\xff\x7f" : "9999");
                break;
            default:
                bytes.resize(at);
                break;
        }
    }
    return bytes;
}

void mutate_folder(const std::string& name) {
    const auto folder = test::data_folder() / name;
    if (!std::filesystem::is_directory(folder)) {
        GTEST_SKIP() << "skipped: there is no corpus " << folder;
    }
    core::Random random(20261121);
    const core::TemporaryFolder work;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        files.push_back(entry.path());
        std::filesystem::copy_file(entry.path(), work.path() / entry.path().filename());
    }
    std::sort(files.begin(), files.end());
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
    std::size_t read = 0;
    std::size_t refused = 0;
    for (int round = 0; round < 400 && std::chrono::steady_clock::now() < end; ++round) {
        for (const auto& file : files) {
            const auto target = work.path() / file.filename();
            const std::string whole = core::read_file(file);
            std::ofstream(target, std::ios::binary) << changed(whole, random);
            try {
                (void)postproc::read_field(target);
                ++read;
            } catch (const core::Error&) {
                ++refused;
            }
            std::ofstream(target, std::ios::binary) << whole;
        }
    }
    EXPECT_GT(refused, 0U);
    EXPECT_GT(read + refused, files.size());
}

}  // namespace

TEST(ImporterSmoke, ChangedFluentFilesAreReadOrRefused) { mutate_folder("fluent_legacy"); }
TEST(ImporterSmoke, ChangedEnsightFilesAreReadOrRefused) { mutate_folder("ensight"); }

}  // namespace underbody
