// One byte of any file that a study may rest on, of every importer and every step: what rests on it is made again, what
// does not is not, and a run that goes on from a store gives what a run from nothing gives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "cases/study.h"
#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody::cases {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

class AnyByte : public testing::Test {
protected:
    core::TemporaryFolder scratch;
    fs::path folder = scratch.path() / "study";

    void put(const std::string& name, const std::string& text) { core::write_file(folder / name, text); }
    std::string get(const std::string& name) { return core::read_file(folder / name); }

    StudyResults run(const fs::path& store = {}) {
        RunOptions options;
        options.pictures = false;
        options.store = store;
        options.report = store.empty() ? fs::path() : store.parent_path() / "report" / "index.html";
        return run_study(Study::open(folder), options);
    }
    static Names in_state(const StudyResults& results, std::initializer_list<StepState> states) {
        Names names;
        for (const auto& step : results.steps) {
            if (std::find(states.begin(), states.end(), step.state) != states.end()) {
                names.insert(step.kind + " " + step.name);
            }
        }
        return names;
    }
    /// The words of the CGNS library about a file it cannot open: of one damaged file it tells the first or another
    /// fault, by what the process had open before. That it refused, where and with which hint is compared.
    static std::string without_library_words(const std::string& error) {
        static const std::regex words("(CGNS cannot [a-z ]+: )[^;\n]*(; understood so far: )");
        return std::regex_replace(error, words, "$1...$2");
    }
    /// All that a run says, but for what was computed and what was there.
    static std::string everything(const StudyResults& results) {
        nlohmann::json json = results;
        for (const char* key : {"report", "computed", "reused"}) {
            json.erase(key);
        }
        for (auto& step : json["steps"]) {
            step.erase("reused");
            step["state"] = step["state"] == "failed" ? "failed" : "done";
            if (step.contains("error")) {
                step["error"] = without_library_words(step["error"].get<std::string>());
            }
        }
        return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
    }

    void copy_data(const std::string& from, const std::string& to) {
        fs::create_directories((folder / to).parent_path());
        fs::copy(test::data_folder() / from, folder / to, fs::copy_options::recursive);
        for (const auto& entry : fs::recursive_directory_iterator(folder)) {
            fs::permissions(entry.path(), fs::perms::owner_all, fs::perm_options::add);
        }
    }

    /// Every importer (with what lies beside its files) and every step.
    void write_whole_study() {
        test::write_small_study(folder);
        for (const auto& [mesh, lift] : {std::pair{"coarse", 0.42}, {"medium", 0.405}, {"fine", 0.401}}) {
            put("meshes/block-" + std::string(mesh) + ".csv", test::cube_field(0.003, lift / 1e-3));
        }
        copy_data("fluent_legacy/ascii.cas", "fluent/legacy.cas");
        copy_data("fluent_legacy/ascii.dat", "fluent/legacy.dat");
        copy_data("fluent_hdf5", "cff");
        copy_data("ensight", "ensight");
        copy_data("openfoam/ascii", "foam/a");
        put("foam/a/case.foam", "");
        copy_data("openfoam/decomposed", "foam/split");
        put("foam/split/case.foam", "");
        copy_data("cgns/cfx-like.cgns", "cgns/cfx.cgns");
        put("monitors/wing.csv", test::cube_field(0.003, 400));
        std::string monitor = "\"lift\"\n\"Iteration\" \"lift\"\n(\"Iteration\" \"lift\")\n";
        for (int i = 1; i <= 60; ++i) {
            monitor += std::to_string(i) + " " + core::format_number(0.2 * (1 + 0.01 * (i % 2))) + "\n";
        }
        put("monitors/wing-lift.out", monitor);
        put("added.csv", "gap [mm], added_mass_heave [kg]\n1, 2.1\n6, 2\n20, 1.9\n");
        put("tables/more.csv", "gap [mm], lift_force [N]\n1, 0.01\n3, 0.005\n6, 0\n");
        std::string model = get("glide.toml");
        const std::string mass = "added_mass_heave = \"2 kg\"";
        model.replace(model.find(mass), mass.size(), "added_mass_heave = \"added.csv\"");
        put("glide.toml", model + "[[force]]\nquantity = \"lift_force\"\ntable = \"tables/more.csv\"\n");
        put("static.toml",
            "[vehicle]\nmass = \"2 kg\"\nnet_weight = \"0.35 N\"\n[drag.heave]\nlinear = \"0.5 N s/m\"\n"
            "[[force]]\nquantity = \"lift_force\"\ntable = \"tables/more.csv\"\n");
        put("rig/dataset.toml",
            "kind = \"static\"\ntitle = \"t\"\n[conditions]\nspeed = \"0.5 m/s\"\n[[run]]\nfile = \"a.csv\"\n");
        std::string rows = "gap [mm], lift_force [N], lift_force_sigma [N]\n";
        for (int i = 0; i < 12; ++i) {
            rows += core::format_number(1 + i / 3.0, 6) + ", " + core::format_number(0.01 - i * 3e-4, 6) + ", 0.0002\n";
        }
        put("rig/a.csv", rows);
        put("shapes/body.toml",
            "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n");
        put("notes/readme.txt", "nobody reads this\n");
        std::string text = get("study.toml");
        const auto at = text.find("columns = 40\nrows = 40");
        text.replace(at, 22, "columns = 12\nrows = 12");
        const auto exports = text.find("[\"c\", \"csv\"]");
        text.replace(exports, 12, "[\"c\", \"csv\", \"json\", \"mat\", \"jsbsim\"]");
        put("study.toml", text +
                              "[reference]\ndensity = \"998 kg/m^3\"\n"
                              "[[case]]\nfiles = \"meshes/{variant}-{mesh}.csv\"\nconditions.gap = \"3 mm\"\n"
                              "[[case]]\nfiles = \"fluent/{variant}.dat\"\nzones = [\"*\"]\n"
                              "[[case]]\nfiles = \"cff/{variant}.dat.h5\"\nzones = [\"*\"]\n"
                              "[[case]]\nfiles = \"ensight/{variant}.encas\"\nzones = [\"*\"]\n"
                              "[[case]]\nfiles = \"foam/{variant}/case.foam\"\nzones = [\"*\"]\n"
                              "[[case]]\nfiles = \"cgns/{variant}.cgns\"\nzones = [\"*\"]\n"
                              "[[case]]\nfiles = \"monitors/{variant}.csv\"\n"
                              "[[mesh_uncertainty]]\nname = \"3 mm\"\nwhere = { variant = \"block\" }\nquantities = "
                              "[\"lift_force\"]\n"
                              "cells = { coarse = 1000, medium = 8000, fine = 64000 }\n"
                              "[[body]]\nname = \"hull\"\nshape = \"shapes/body.toml\"\n"
                              "[[table]]\nname = \"second\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\nwhere = { "
                              "variant = \"cube\" }\n"
                              "mesh_uncertainty = \"3 mm\"\nfit = \"interpolation\"\n"
                              "[[compare]]\nname = \"both\"\ntables = [\"lift\", \"second\"]\n"
                              "[[measurement]]\nname = \"rig\"\nmodel = \"static.toml\"\ndata = \"rig\"\n");
    }

    /// The loads that must be made again (or fail) when the file changes; nullopt: see the rest of the rules.
    static std::optional<Names> direct(const std::string& file) {
        const std::string stem = fs::path(file).stem().string();
        if (file.starts_with("fields/") || file.starts_with("meshes/")) {
            return Names{"loads " + stem};
        }
        if (file.starts_with("fluent/")) {
            return Names{"loads legacy"};
        }
        if (file.starts_with("monitors/")) {
            return Names{"loads wing"};
        }
        if (file.starts_with("cgns/")) {
            return Names{"loads cfx"};
        }
        static const std::map<std::string, Names> others = {
            {"forces.csv", {"verify solver"}}, {"glide.toml", {"region map"}},  // a map that fails has no model
            {"added.csv", {"region map"}},     {"tables/more.csv", {"region map", "residual rig"}},
            {"static.toml", {"residual rig"}}, {"rig/dataset.toml", {"residual rig"}},
            {"rig/a.csv", {"residual rig"}},   {"shapes/body.toml", {"body hull"}},
            {"notes/readme.txt", {}},
        };
        const auto found = others.find(file);
        return found == others.end() ? std::nullopt : std::optional(found->second);
    }

    /// What may be made again at most.
    static bool may_rest_on(const std::string& step, const std::string& file) {
        const auto of = [&](std::initializer_list<const char*> kinds) {
            return std::any_of(kinds.begin(), kinds.end(),
                               [&](const char* kind) { return step.starts_with(std::string(kind) + " "); });
        };
        if (const auto first = direct(file); first && first->contains(step)) {
            return true;
        }
        if (step == "model map" && (file == "glide.toml" || file == "added.csv" || file == "tables/more.csv")) {
            return true;
        }
        if (file.starts_with("fields/")) {
            return of({"table", "export", "region", "model", "compare", "verify"});
        }
        if (file.starts_with("meshes/")) {  // the error that the second table takes
            return of({"mesh", "table", "compare", "verify"});
        }
        const std::string family = file.substr(0, file.find('/'));
        if (family == "foam" || family == "ensight" || family == "cff" || family == "fluent" || family == "cgns" ||
            family == "monitors") {
            return of({"loads", "verify"});
        }
        return file == "study.toml";
    }
};

TEST_F(AnyByte, TheWordsOfTheLibraryAloneAreLeftOut) {
    const std::string one =
        "a.cgns: CGNS cannot open it: mismatch in IDs read; understood so far: the format\n  hint: h";
    EXPECT_EQ(
        without_library_words(one),
        without_library_words("a.cgns: CGNS cannot open it: no attribute; understood so far: the format\n  hint: h"));
    EXPECT_NE(without_library_words(one), without_library_words("b.cgns: CGNS cannot open it: mismatch in IDs read; "
                                                                "understood so far: the format\n  hint: h"));
    EXPECT_NE(without_library_words(one), without_library_words("a.cgns: CGNS cannot open it: mismatch in IDs read; "
                                                                "understood so far: zones\n  hint: h"));
    EXPECT_EQ(without_library_words("a.dat: cannot be read: x; y"), "a.dat: cannot be read: x; y");
}

TEST_F(AnyByte, OfAnyFileMakesExactlyWhatRestsOnItNewAndGivesWhatARunFromNothingGives) {
    write_whole_study();
    const StudyResults first = run();
    const Names failed = in_state(first, {StepState::failed});
    EXPECT_TRUE(failed.empty()) << testing::PrintToString(failed);
    ASSERT_TRUE(in_state(run(), {StepState::computed}).empty());
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = entry.path().lexically_relative(folder).generic_string();
        if (entry.is_regular_file() && !name.starts_with(".underbody") && !name.starts_with("report") &&
            entry.file_size() > 0) {
            files.push_back(name);
        }
    }
    std::sort(files.begin(), files.end());
    // A few files in every run of the tests, all of them several times on demand.
    const bool all = std::getenv("UNDERBODY_ALL_KILLS") != nullptr;
    core::Random random(20261122);
    const std::size_t rounds = all ? 4 * files.size() : 40;
    std::size_t with_effect = 0;
    std::map<std::string, int> others_since;  // results of a step since its true one was made
    for (std::size_t round = 0; round < rounds; ++round) {
        const std::string file =
            files[all ? round % files.size()
                      : static_cast<std::size_t>(random.uniform(0, 1) * 0.999999 * static_cast<double>(files.size()))];
        const std::string whole = get(file);
        std::string changed = whole;
        const auto at = static_cast<std::size_t>(random.uniform(0, 1) * 0.999999 * static_cast<double>(whole.size()));
        changed[at] = static_cast<char>(changed[at] ^ 1);
        put(file, changed);
        const std::string where = file + " at byte " + std::to_string(at);
        try {
            const StudyResults now = run();
            const Names made = in_state(now, {StepState::computed, StepState::failed});
            for (const auto& step : made) {
                EXPECT_TRUE(may_rest_on(step, file)) << step << " was made again: " << where;
            }
            if (const auto must = direct(file)) {
                for (const auto& step : *must) {
                    EXPECT_TRUE(made.contains(step)) << step << " is of before: " << where;
                }
            }
            with_effect += made.empty() ? 0 : 1;
            for (const auto& step : made) {
                ++others_since[step];
            }
            if (round % 4 == 0) {
                const core::TemporaryFolder fresh;
                EXPECT_EQ(everything(now), everything(run(fresh.path() / "store.sqlite"))) << where;
            }
        } catch (const core::Error&) {
            EXPECT_EQ(file, "study.toml") << where;
        }
        put(file, whole);
        for (const auto& step : in_state(run(), {StepState::computed, StepState::failed})) {
            EXPECT_GE(others_since[step], 8) << step << " was made again: " << where << ", put back";
            others_since[step] = 0;  // eight of a name are kept
        }
    }
    EXPECT_GT(with_effect, rounds / 3);
}

}  // namespace
}  // namespace underbody::cases
