// Cases on two cores by MPI, with OpenFOAM itself, through a real Slurm: cut twice, by a kill and by a more urgent job.
// Skipped, saying why, where one of them is missing.
#include <cmath>
#include <fstream>
#include <set>

#include "core/file.h"
#include "core/text.h"
#include "tests/studio/real_slurm.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* case_name = "ellipse-h20-p1-u0.5";
constexpr int iterations = 72, start_iterations = 24, checkpoint_interval = 9;

/// Rows of forces, by iteration: those of a later start replace what was lost in a cut.
std::map<int, std::string> force_rows(const fs::path& folder) {
    std::map<int, fs::path> starts;
    const fs::path forces = folder / "postProcessing" / "forces";
    if (fs::is_directory(forces)) {
        for (const auto& entry : fs::directory_iterator(forces)) {
            starts[static_cast<int>(core::parse_integer(entry.path().filename().string()).value_or(-1))] = entry.path();
        }
    }
    std::map<int, std::string> rows;
    for (const auto& [start, at] : starts) {
        const fs::path file = at / "force.dat";
        const std::string text = fs::exists(file) ? core::read_file(file) : "";
        for (const auto line : core::split(text, '\n')) {
            const auto iteration = core::parse_integer(line.substr(0, line.find_first_of(" \t")));
            if (iteration && line.ends_with(")")) {
                rows[static_cast<int>(*iteration)] = std::string(line);
            }
        }
    }
    return rows;
}

/// The iterations that a run began from.
std::set<int> starts_of(const fs::path& folder) {
    std::set<int> starts;
    for (const auto& entry : fs::directory_iterator(folder / "postProcessing" / "forces")) {
        starts.insert(static_cast<int>(core::parse_integer(entry.path().filename().string()).value_or(-1)));
    }
    return starts;
}

/// Processes that work in a folder or below it.
std::vector<std::string> at_work_in(const fs::path& folder) {
    std::vector<std::string> found;
    const std::string there = fs::weakly_canonical(folder).string();
    for (const auto& entry : fs::directory_iterator("/proc")) {
        std::error_code gone;
        const fs::path where = fs::read_symlink(entry.path() / "cwd", gone);
        if (!gone && where.string().starts_with(there)) {
            std::ifstream name(entry.path() / "comm");
            std::string word;
            std::getline(name, word);
            found.push_back(word + " " + entry.path().filename().string());
        }
    }
    return found;
}

TEST_F(RealSlurm, OpenFoamOnTwoCoresGoesOnFromItsDecomposedCheckpoint) {
    fs::remove_all(folder_.path() / "bin");  // no stand-in
    for (const char* program : {"simpleFoam", "decomposePar", "reconstructPar", "mpirun"}) {
        if (!fs::exists(fs::path("/usr/bin") / program)) {
            GTEST_SKIP() << "skipped: there is no " << program << " (apt-get install openfoam openmpi-bin)";
        }
    }
    write_study("study", "\"20 mm\"");
    const fs::path file = folder_.path() / "study" / "study.toml";
    std::string text = core::read_file(file);
    text.replace(
        text.find("mesher = "), std::string::npos,
        "mesh_density = \"draft\"\niterations = " + std::to_string(iterations) + "\n[sweep.slurm]\ncores = 2\n");
    core::write_file(file, text);
    for (const char* other : {"again", "uncut"}) {
        fs::copy(folder_.path() / "study", folder_.path() / other, fs::copy_options::recursive);
    }
    const fs::path unfinished = runs() / (std::string(case_name) + ".unfinished");
    // Forces of the next iteration: the checkpoint before it is whole on both cores.
    const auto solved_past = [&](int iteration) {
        std::size_t known = 0;
        // As long as it gets on: the machine may have much else to do.
        while (wait_for([&] { return force_rows(unfinished).size() > known; }, 200)) {
            const auto rows = force_rows(unfinished);
            known = rows.size();
            if (rows.contains(iteration + 1)) {
                return true;
            }
        }
        return false;
    };
    const auto all_have_ended = [&] { return wait_for([&] { return at_work_in(unfinished).empty(); }, 60); };
    const auto has = [&](const fs::path& part, int time) {
        return fs::exists(unfinished / part / std::to_string(time) / "U");
    };

    // Killed.
    std::string job = submit();
    const int first = start_iterations / checkpoint_interval * checkpoint_interval + checkpoint_interval;
    ASSERT_TRUE(solved_past(first)) << json(states()) << slurm("squeue", {}).output;
    ASSERT_EQ(slurm("scancel", {"--signal=KILL", "--full", job + "_1"}).exit_code, 0);
    ASSERT_TRUE(wait_for([&] { return count(states(), "missing") == 1; })) << json(states());
    EXPECT_TRUE(all_have_ended()) << testing::PrintToString(at_work_in(unfinished));
    EXPECT_TRUE(has("processor0", first) && has("processor1", first) && !has(".", first)) << "decomposed";

    // Preempted: it goes on from there, and is cut again.
    job = submit();
    const int second = first + checkpoint_interval;
    ASSERT_TRUE(solved_past(second)) << json(states()) << slurm("squeue", {}).output;
    ASSERT_EQ(
        slurm("sbatch", {"--partition=urgent", "--ntasks=2", "--output=/dev/null", "--wrap", "sleep 1"}).exit_code, 0);
    ASSERT_TRUE(wait_for([&] { return count(states(), "waiting") == 1; })) << json(states());
    EXPECT_TRUE(all_have_ended()) << testing::PrintToString(at_work_in(unfinished));
    EXPECT_TRUE(has("processor0", second) && has("processor1", second)) << "decomposed";
    fs::create_directories(folder_.path() / "again" / "runs");
    fs::copy(unfinished, folder_.path() / "again" / "runs" / unfinished.filename(),
             fs::copy_options::recursive | fs::copy_options::copy_symlinks);
    start_now(job + "_1");
    EXPECT_TRUE(wait_for([&] { return count(states(), "solved") == 1; }, 900)) << json(states());
    const fs::path solved = runs() / case_name;
    EXPECT_TRUE(fs::exists(solved / std::to_string(iterations) / "U"));
    EXPECT_FALSE(fs::exists(solved / "processor0"));
    const std::set<int> starts = starts_of(solved);
    ASSERT_EQ(starts.size(), 3U) << testing::PrintToString(starts);
    EXPECT_EQ(*starts.begin(), start_iterations);
    EXPECT_GE(*std::next(starts.begin()), first);
    EXPECT_GE(*starts.rbegin(), second);
    const auto rows = force_rows(solved);
    EXPECT_EQ(rows.size(), static_cast<std::size_t>(iterations - start_iterations));

    // What was cut goes on to the same bytes here as in Slurm.
    const auto again = run({"sweep", "again", "--cores", "2", "--jobs", "1"});
    ASSERT_EQ(again.exit_code, 0) << again.output << again.errors;
    EXPECT_THAT(again.output, HasSubstr("goes on from iteration " + std::to_string(*starts.rbegin())));
    const auto here = results_below(folder_.path() / "again" / "runs" / case_name), there = results_below(solved);
    EXPECT_GT(here.size(), 30U);
    for (const auto& [name, bytes] : there) {
        ASSERT_TRUE(here.contains(name)) << name;
        EXPECT_EQ(here.at(name), bytes) << name;
    }
    EXPECT_EQ(here.size(), there.size());

    // One that was never cut, made here, has the same forces up to the first cut, and nearly the same at the end (5e-5
    // of the drag apart when this was written): checkpoints have nine digits, and linear solvers end at a relative
    // tolerance.
    const auto uncut = run({"sweep", "uncut", "--cores", "2", "--jobs", "1"});
    ASSERT_EQ(uncut.exit_code, 0) << uncut.output << uncut.errors;
    const auto whole = force_rows(folder_.path() / "uncut" / "runs" / case_name);
    ASSERT_EQ(whole.size(), rows.size());
    for (const auto& [iteration, row] : whole) {
        if (iteration <= *std::next(starts.begin())) {
            EXPECT_EQ(row, rows.at(iteration));
        }
    }
    const auto drag = [](const std::string& row) {
        const auto at = row.find('(') + 2;
        return core::parse_number(row.substr(at, row.find(' ', at) - at)).value_or(HUGE_VAL);
    };
    const double last = drag(rows.at(iterations)), expected = drag(whole.at(iterations));
    EXPECT_NEAR(last, expected, 1e-3 * std::abs(expected));
}

}  // namespace
}  // namespace underbody
