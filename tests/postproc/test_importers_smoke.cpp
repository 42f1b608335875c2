// A short fuzzing of every importer within the normal tests: the small files of tests/data, changed in ways that
// repeat.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>

#include "core/file.h"
#include "core/random.h"
#include "postproc/field/field.h"
#include "postproc/importers/reports/reports.h"
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

using Read = std::function<void(const std::filesystem::path&)>;

/// Every file of the folder changed in turn, the others whole beside it; `read` gets the changed one, or `what` in the
/// folder if that is named.
void mutate_folder(const std::string& name, const Read& read_one, const std::string& what = "") {
    const auto folder = test::data_folder() / name;
    ASSERT_TRUE(std::filesystem::is_directory(folder)) << folder;
    core::Random random(20261121);
    const core::TemporaryFolder work;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) {
            files.push_back(entry.path());
        }
    }
    std::filesystem::copy(folder, work.path(), std::filesystem::copy_options::recursive);
    std::sort(files.begin(), files.end());
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    std::size_t read = 0;
    std::size_t refused = 0;
    for (int round = 0; round < 400 && std::chrono::steady_clock::now() < end; ++round) {
        for (const auto& file : files) {
            const auto target = work.path() / std::filesystem::relative(file, folder);
            const std::string whole = core::read_file(file);
            std::ofstream(target, std::ios::binary) << changed(whole, random);
            try {
                read_one(what.empty() ? target : work.path() / what);
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

const Read read_as_field = [](const std::filesystem::path& path) { (void)postproc::read_field(path); };

TEST(ImporterSmoke, ChangedFluentFilesAreReadOrRefused) { mutate_folder("fluent_legacy", read_as_field); }
TEST(ImporterSmoke, ChangedEnsightFilesAreReadOrRefused) { mutate_folder("ensight", read_as_field); }
TEST(ImporterSmoke, ChangedOpenFoamFilesAreReadOrRefused) {
    for (const char* name : {"openfoam/ascii", "openfoam/binary", "openfoam/packed", "openfoam/decomposed"}) {
        mutate_folder(name, read_as_field, ".");
    }
}
TEST(ImporterSmoke, ChangedFluentHdf5FilesAreReadOrRefused) { mutate_folder("fluent_hdf5", read_as_field); }
TEST(ImporterSmoke, ChangedCgnsFilesAreReadOrRefused) { mutate_folder("cgns", read_as_field); }
TEST(ImporterSmoke, ChangedFluentTablesAreReadOrRefused) { mutate_folder("fluent_ascii", read_as_field); }
TEST(ImporterSmoke, ChangedCsvFilesAreReadOrRefused) { mutate_folder("cfd_post_csv", read_as_field); }
TEST(ImporterSmoke, ChangedVtkFilesAreReadOrRefused) { mutate_folder("vtk_files", read_as_field); }
TEST(ImporterSmoke, ChangedReportsAreReadOrRefused) {
    mutate_folder("reports", [](const std::filesystem::path& path) {
        int refused = 0;
        const auto count = [&](const auto& read) {
            try {
                (void)read(path);
            } catch (const core::Error&) {
                ++refused;
            }
        };
        count(postproc::read_monitor);
        count(postproc::read_plot);
        count(postproc::read_force_reports);
        if (refused == 3) {
            throw core::InputError("format", "nobody reads it");
        }
    });
}

}  // namespace underbody
