// What is read is noted: every file that an importer opens, and every place where it looks for one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <set>
#include <thread>

#include "cases/file_states.h"
#include "core/file.h"
#include "core/inputs.h"
#include "core/parallel.h"
#include "core/random.h"
#include "postproc/field/field.h"
#include "postproc/loads/loads.h"
#include "tests/support/support.h"
#ifdef UNDERBODY_WATCHES_SYSTEM_CALLS
#include "tests/cases/system_calls.h"
#endif

namespace underbody {
namespace {

namespace fs = std::filesystem;
using core::Input;
using testing::Contains;
using testing::Not;

struct Recorded {
    std::set<std::string> contents;  ///< files that are there, relative to the folder
    std::set<std::string> absent;
    std::vector<cases::StoredInput> inputs;
    bool read = false;  ///< not refused
};

std::string below(const fs::path& file, const fs::path& folder) {
    return file.lexically_normal().lexically_relative(folder).string();
}

template <class Work>
Recorded recorded(const fs::path& folder, const Work& work) {
    cases::FileStates states(folder, {});
    core::InputRecord record([&](const Input& input) { return states.state_of(input); });
    Recorded result;
    {
        const core::RecordInputs scope(record);
        try {
            work();
            result.read = true;
        } catch (const core::Error&) {
            result.read = false;
        }
    }
    for (const auto& [input, state] : record.entries()) {
        result.inputs.push_back({input.kind, states.stored_path(input.path), input.pattern, state});
        const std::string name = below(input.path, folder);
        if (state == "absent") {
            result.absent.insert(name);
        } else if (input.kind == Input::Kind::content && state != "folder") {
            result.contents.insert(name);
        }
    }
    return result;
}

bool still(const Recorded& one, const fs::path& folder) {
    cases::FileStates now(folder, {});
    return std::all_of(one.inputs.begin(), one.inputs.end(), [&](const auto& input) { return now.still(input); });
}

/// Every file of a folder as the one that the user names, the others beside it.
class Importers : public testing::TestWithParam<const char*> {
protected:
    fs::path source() const {
        const std::string name = GetParam();
        return name.starts_with("samples/") ? test::shared_folder() / name : test::data_folder() / name;
    }
};

TEST_P(Importers, NoteWhatTheyOpenAndSeeEachByteOfIt) {
    if (!fs::exists(source())) {
        GTEST_SKIP() << "skipped: " << source() << " is not here (set UNDERBODY_SHARED to the folder that has it)";
    }
    const core::TemporaryFolder work;
    const fs::path folder = fs::canonical(work.path());
    fs::copy(source(), folder, fs::copy_options::recursive);
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        fs::permissions(entry.path(), fs::perms::owner_all, fs::perm_options::add);
        if (entry.is_regular_file()) {
            files.push_back(entry.path());
        }
    }
    std::vector<fs::path> named = files;
    if (std::string(GetParam()).starts_with("openfoam")) {
        core::write_file(folder / "case.foam", "");
        named = {folder, folder / "case.foam", folder / "system" / "controlDict"};
    }
    core::Random random(20261122);
    std::size_t understood = 0;
    for (const auto& file : named) {
        postproc::ReadOptions options;
        options.length_unit = "m";
        options.surfaces_only = true;
        const auto read = [&] {
            try {
                (void)postproc::read_field(file, options);
            } catch (const core::UsageError&) {
                postproc::ReadOptions plain;
                (void)postproc::read_field(file, plain);
            } catch (const core::InputError&) {
                (void)postproc::read_field(file);
            }
        };
        Recorded found;
#ifdef UNDERBODY_WATCHES_SYSTEM_CALLS
        const test::OpenedFiles opened(folder.string());
        found = recorded(folder, read);
        for (const auto& path : opened.paths()) {
            if (fs::is_regular_file(path)) {
                EXPECT_THAT(found.contents, Contains(below(path, folder)))
                    << "opened for " << file << ", and not noted";
            }
        }
#else
        found = recorded(folder, read);
#endif
        understood += found.read ? 1 : 0;
        ASSERT_TRUE(still(found, folder)) << file;
        // One byte anywhere, and it is no longer true; a byte of another file changes nothing.
        for (const auto& other : files) {
            const std::string whole = core::read_file(other);
            if (whole.empty() || whole.size() > 4000000) {
                continue;
            }
            std::string changed = whole;
            changed[static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(whole.size())) %
                    whole.size()] ^= 1;
            core::write_file(other, changed);
            EXPECT_EQ(still(found, folder), !found.contents.contains(below(other, folder))) << file << " and " << other;
            core::write_file(other, whole);
        }
        EXPECT_TRUE(still(found, folder)) << file;
        // A companion that appears is seen, as is one that goes.
        for (const auto& name : found.absent) {
            if (!name.starts_with("..") && fs::is_directory((folder / name).parent_path())) {
                core::write_file(folder / name, "here now");
                EXPECT_FALSE(still(found, folder)) << file << ": " << name;
                fs::remove(folder / name);
            }
        }
        for (const auto& name : found.contents) {
            if (!name.starts_with("..")) {
                fs::rename(folder / name, folder.string() + ".away");
                EXPECT_FALSE(still(found, folder)) << file << ": " << name;
                fs::rename(folder.string() + ".away", folder / name);
            }
        }
    }
    EXPECT_GT(understood, 0U);
}

INSTANTIATE_TEST_SUITE_P(Formats, Importers,
                         testing::Values("cfd_post_csv", "cgns", "ensight", "fluent_ascii", "fluent_hdf5",
                                         "fluent_legacy", "vtk_files", "openfoam/ascii", "openfoam/binary",
                                         "openfoam/packed", "openfoam/decomposed", "samples/cfx_csv", "samples/cgns",
                                         "samples/ensight/CylinderCrossflow", "samples/fluent_cff", "samples/tecplot"),
                         [](const auto& one) {
                             std::string name = one.param;
                             std::replace_if(
                                 name.begin(), name.end(),
                                 [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
                             return name;
                         });

TEST(Inputs, TheMeshBesideTheDataIsOneAndSoIsTheNameThatComesFirst) {
    const core::TemporaryFolder folder;
    fs::copy(test::data_folder() / "fluent_legacy" / "ascii.dat", folder.path() / "run-1-00010.dat");
    fs::copy(test::data_folder() / "fluent_legacy" / "ascii.cas", folder.path() / "run.cas");
    const auto found = recorded(folder.path(), [&] { (void)postproc::read_field(folder.path() / "run-1-00010.dat"); });
    EXPECT_TRUE(found.read);
    EXPECT_THAT(found.contents, testing::ElementsAre("run-1-00010.dat", "run.cas"));
    EXPECT_THAT(found.absent, testing::IsSupersetOf({"run-1-00010.cas", "run-1.cas"}));
}

TEST(Inputs, ATimeThatAppearsInAnOpenFoamCaseIsSeenAndALogIsNot) {
    const core::TemporaryFolder folder;
    fs::copy(test::data_folder() / "openfoam" / "ascii", folder.path() / "run", fs::copy_options::recursive);
    const auto found = recorded(folder.path(), [&] { (void)postproc::read_field(folder.path() / "run"); });
    core::write_file(folder.path() / "run" / "log.pisoFoam", "a log");
    core::write_file(folder.path() / "run" / "0.0025" / "notes", "of a time that is not read");
    EXPECT_TRUE(still(found, folder.path()));
    fs::create_directory(folder.path() / "run" / "0.0075");
    EXPECT_FALSE(still(found, folder.path()));
    fs::remove(folder.path() / "run" / "0.0075");
    EXPECT_TRUE(still(found, folder.path()));
    core::write_file(folder.path() / "run" / "0.005" / "T", "another field");
    EXPECT_FALSE(still(found, folder.path()));
}

TEST(Inputs, PiecesOfACollectionOfVtkAreNoted) {
    const core::TemporaryFolder folder;
    fs::copy(test::data_folder() / "vtk_files" / "tetrahedron.vtu", folder.path() / "parts_0.vtu",
             fs::copy_options::overwrite_existing);
    core::write_file(
        folder.path() / "all.vtm",
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\">\n<vtkMultiBlockDataSet>\n"
        "<DataSet index=\"0\" name=\"a\" file=\"parts_0.vtu\"/>\n</vtkMultiBlockDataSet>\n</VTKFile>\n");
    const auto found = recorded(folder.path(), [&] { (void)postproc::read_field(folder.path() / "all.vtm"); });
    EXPECT_THAT(found.contents, testing::ElementsAre("all.vtm", "parts_0.vtu"));
}

TEST(Inputs, AreNotedInParallelLoopsAndInNestedScopesButNotInAScratchFolder) {
    const core::TemporaryFolder folder;
    for (int i = 0; i < 40; ++i) {
        core::write_file(folder.path() / std::to_string(i), "x");
    }
    core::write_file(folder.path() / "own" / "scratch", "x");
    Recorded inner;
    const auto outer = recorded(folder.path(), [&] {
        inner = recorded(folder.path(), [&] {
            core::parallel_for(40, [&](std::size_t i) { (void)core::read_file(folder.path() / std::to_string(i)); });
        });
        const core::RecordInputs own(folder.path() / "own");
        (void)core::read_file(folder.path() / "own" / "scratch");
    });
    EXPECT_EQ(inner.contents.size(), 40U);
    EXPECT_EQ(outer.contents, inner.contents);
    EXPECT_THAT(outer.contents, Not(Contains("own/scratch")));
}

TEST(Inputs, NamesThatFitAreThoseThatTheFolderGives) {
    const core::TemporaryFolder folder;
    core::Random random(5);
    for (int i = 0; i < 200; ++i) {
        std::string name;
        for (std::size_t k = 0; k <= random.below(4); ++k) {
            name += "ab.-1"[random.below(5)];
        }
        if (name != "." && name != ".." && !fs::exists(folder.path() / name)) {
            if (random.below(5) == 0) {
                fs::create_directories(folder.path() / name);
            } else {
                std::ofstream(folder.path() / name) << "x";
            }
        }
    }
    const auto all = core::names_in_folder(folder.path(), "*");
    ASSERT_GT(all.size(), 20U);
    for (const std::string pattern :
         {"*", "a*", "ab*", "[!.]*", "*.1", "a?b", ".*", "b", "[-+.0-9]*", "\\a*", "", "zz*"}) {
        EXPECT_EQ(core::names_that_fit(all, pattern), core::names_in_folder(folder.path(), pattern)) << pattern;
    }
}

TEST(Inputs, ANameThatAppearsInAFolderAlreadyListedIsSeen) {
    const core::TemporaryFolder folder;
    const auto touch = [&](const char* name) { std::ofstream(folder.path() / name) << "x"; };
    touch("a.dat");
    cases::FileStates states(folder.path(), {});
    const core::Input beside{core::Input::Kind::names, folder.path(), "a*"};
    const std::string young = states.state_of(beside);
    touch("a.out");
    const std::string two = states.state_of(beside);
    EXPECT_NE(two, young);
    std::this_thread::sleep_for(std::chrono::milliseconds(3300));  // old enough to be kept
    EXPECT_EQ(states.state_of(beside), two);
    EXPECT_EQ(states.state_of(beside), two);
    touch("b.dat");
    EXPECT_EQ(states.state_of(beside), two);  // another case's
    touch("a.trn");
    EXPECT_NE(states.state_of(beside), two);
    fs::remove_all(folder.path());
    EXPECT_EQ(states.state_of(beside), states.state_of({core::Input::Kind::names, folder.path(), "nothing*"}));
    fs::create_directories(folder.path());
}

TEST(Inputs, AFileThatChangesWhileItIsReadIsNoLongerTrue) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "f", "before");
    const auto found = recorded(folder.path(), [&] {
        const core::MappedFile file(folder.path() / "f");
        core::write_file(folder.path() / "f", "after!");
    });
    EXPECT_FALSE(still(found, folder.path()));
}

}  // namespace
}  // namespace underbody
