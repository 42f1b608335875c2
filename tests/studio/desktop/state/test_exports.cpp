// Exports of a study's tables: of which force they are, when they are stale, and how they are made again.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/accept.h"
#include "core/file.h"
#include "studio/desktop/state/actions.h"
#include "studio/desktop/state/exports.h"
#include "tests/studio/desktop/few_gaps.h"
#include "tests/support/support.h"

namespace underbody::studio {
namespace {

namespace fs = std::filesystem;

/// A study of a few cases whose map's vehicle was held against a log, and what was found: rougher ground.
class FoundRoughness : public ::testing::Test {
protected:
    FoundRoughness() {
        test::make_few_gaps(folder_.path());
        const auto run = test::run_underbody({"study", "run", folder_.path().string(), "--no-pictures"});
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        fs::copy(test::source_folder() / "cases" / "evie" / "heave", folder_.path() / "heave",
                 fs::copy_options::recursive);
        core::write_file(folder_.path() / "study.toml",
                         core::read_file(folder_.path() / "study.toml") +
                             "\n[[measurement]]\nname = \"tank\"\nmodel = \"report/models/glide/model.toml\"\n"
                             "data = \"heave\"\n");
        const fs::path map = folder_.path() / "report" / "models" / "glide";
        nlohmann::json files;
        for (const auto& entry : fs::directory_iterator(map)) {
            files[entry.path().filename().string()] = core::read_file(entry.path());
        }
        files["model.toml"] = files["model.toml"].get<std::string>() +
                              "\n[[effect]]\nname = \"surface_roughness\"\nnear = 0.2\nfar = 0.1\nlength = \"30 mm\"\n";
        auto made = std::make_shared<Session>(*open_session(folder_.path()));
        made->results.documents.emplace_back(
            "discovery/tank", R"({"verdict": "effect", "sentence": "The model lacks surface_roughness."})");
        made->results.documents.emplace_back("found-model/tank", files.dump());
        session_ = made;
        state_.study = session_->folder.string();
    }
    const core::TemporaryFolder folder_;
    SessionPointer session_;
    State state_;
};

// Journey 5, step 5: accepted, the exports of the force that the effect changes are stale, and are made again with it.
TEST_F(FoundRoughness, ChangesTheForceThatIsExported) {
    const std::string file = (folder_.path() / "lift.h").string();
    ExportRecord record;
    record.table = record.name = "lift";
    core::Progress& nobody = core::Progress::none();
    record = export_again(*session_, file, record, nobody);
    state_.exports[file] = record;
    EXPECT_TRUE(stale_exports(state_, *session_).empty());
    const std::string before = core::read_file(file);
    EXPECT_TRUE(foreign_files(state_, {file}).empty());

    const State accepted = applied(state_, words_of("accept tank"), *session_);
    const SessionPointer with = with_models(session_, accepted.accepted);
    EXPECT_EQ(with->study.regions.front().model, with->study.measurements.front().model) << "the map follows";
    EXPECT_TRUE(with->study.regions.front().forces.empty()) << "the found model has the table already";
    EXPECT_EQ(stale_exports(accepted, *with), std::vector<std::string>{file});
    const TableOfStudy of = table_of_study(*with, "lift");
    EXPECT_EQ(of.found, "surface_roughness, found of 'tank'");
    const std::string model = (folder_.path() / "models" / "tank" / "model.toml").string();
    EXPECT_EQ(of.line(of.command("lift_force", file, record)),
              "underbody study accept " + folder_.path().string() + " tank && underbody export " + model +
                  " --quantity lift_force --format c --out " + file + " --name lift --axes gap");
    const auto plain = exported_table(*session_, "lift", {}, nobody), force = exported_table(*with, "lift", {}, nobody);
    for (const double gap : {0.002, 0.005, 0.013}) {
        const double x = std::pow(gap / 0.03, 2);
        EXPECT_NEAR(force.value(&gap), plain.value(&gap) * (1 + 0.2 / (1 + x) - 0.1 * x / (1 + x)), 1e-3) << gap;
    }
    State again = accepted;
    again.exports[file] = export_again(*with, file, record, nobody);
    EXPECT_TRUE(stale_exports(again, *with).empty());
    EXPECT_NE(core::read_file(file), before);
    EXPECT_NE(core::read_file(file).find("surface_roughness"), std::string::npos) << "its head says it";
    const State back = applied(again, words_of("unaccept tank"), *with);
    EXPECT_EQ(stale_exports(back, *with_models(with, back.accepted)), std::vector<std::string>{file});
    EXPECT_EQ(foreign_files(accepted, {file}), std::vector<std::string>{file}) << "not the one that was remembered";

    // The same by the command, and what was written into the study is what was accepted.
    cases::write_accepted(session_->study, cases::accept_model(session_->study, session_->results, "tank"));
    const SessionPointer written = open_session(folder_.path());
    EXPECT_TRUE(written->study.regions.front().forces.empty());
    EXPECT_EQ(table_digest(*written, "lift"), table_digest(*with, "lift"));
    EXPECT_TRUE(table_of_study(*written, "lift").first.empty());
    const std::string by_command = (folder_.path() / "by_command.h").string();
    Words line = of.command("lift_force", by_command, record);
    line.erase(line.begin());
    const auto run = test::run_underbody(line);
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    const auto numbers = [](const std::string& text) { return text.substr(text.find("#ifndef")); };
    EXPECT_EQ(numbers(core::read_file(by_command)), numbers(core::read_file(file)));
}

// The tree asks for the digests of all exports again and again: models are read once as long as they stay as they are.
TEST_F(FoundRoughness, IsReadOnceAsLongAsItsFilesStay) {
    const SessionPointer with = with_models(session_, {"tank"});
    const std::string before = table_digest(*with, "lift");
    EXPECT_NE(before, table_digest(*session_, "lift"));
    const fs::path model = with->study.measurements.front().model;
    const auto time = fs::last_write_time(model);
    const std::string text = core::read_file(model);
    std::string other = text;
    other.replace(other.find("near = 0.2"), 10, "near = 0.3");
    core::write_file(model, other);
    fs::last_write_time(model, time);
    EXPECT_EQ(table_digest(*with, "lift"), before) << "of that size and time it is not read again";
    const SessionPointer again = std::make_shared<Session>(*with);
    EXPECT_NE(table_digest(*again, "lift"), before) << "another session reads it";
    fs::last_write_time(model, time + std::chrono::seconds(2));
    EXPECT_EQ(table_digest(*with, "lift"), table_digest(*again, "lift")) << "what was written meanwhile counts";
}

TEST_F(FoundRoughness, PoliciesBeyondTheEndsAreThoseThatAreAskedFor) {
    core::Progress& nobody = core::Progress::none();
    const SessionPointer with = with_models(session_, {"tank"});
    for (const Session* session : {session_.get(), with.get()}) {
        const auto own = exported_table(*session, "lift", {}, nobody);
        EXPECT_EQ(own.axes().front().range, tables::RangePolicy::clamp);
        const auto other = exported_table(*session, "lift", {{"gap", "extrapolate"}, {"pitch", "refuse"}}, nobody);
        EXPECT_EQ(other.axes().front().range, tables::RangePolicy::extrapolate);
        const double gap = 0.004;
        EXPECT_NEAR(other.value(&gap), own.value(&gap), 1e-12);
    }
}

}  // namespace
}  // namespace underbody::studio
