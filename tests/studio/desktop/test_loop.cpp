// Loop: measurements and logs that are dropped on the window, from the file to the verdict and what is made of it.
// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "surrogates/discovery/wording.h"
// clang-format on

#include <QComboBox>
#include <QDropEvent>
#include <QLabel>
#include <QLineEdit>
#include <QMimeData>
#include <QPushButton>
#include <QTextBrowser>
#include <QUrl>
#include <QWindow>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/add_measurement.h"
#include "core/text.h"
#include "studio/desktop/desk.h"
#include "studio/desktop/discovery_panel.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/jobs.h"
#include "studio/desktop/measurement_sheet.h"
#include "studio/desktop/take_in_sheet.h"
#include "surrogates/discovery/run_split.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

/// A table of its own headings, as people's loggers write it.
void write_flight(const fs::path& file) {
    std::string text = "t_ms,rng_cm\n";
    for (int i = 0; i < 400; ++i) {
        text += std::to_string(20 * i) + "," + core::format_number(9.1 + 0.05 * std::sin(0.02 * i)) + "\n";
    }
    core::write_file(file, text);
}

class Dropped : public Window {
protected:
    MeasurementSheet* drop(const std::vector<fs::path>& files) {
        window_->take_files(files);
        settle(*window_);
        auto* sheet = window_->findChild<MeasurementSheet*>();
        EXPECT_NE(sheet, nullptr) << window_->last_error().toStdString();
        return sheet;
    }
    /// By the vehicle alone: the tables of the map's vehicle, which is offered first, end below the gaps of the flight.
    void judge_by_the_vehicle_alone(MeasurementSheet& sheet, const fs::path& study) {
        for (auto* box : sheet.findChildren<QComboBox*>()) {
            if (box->accessibleName() == "Model that it is judged by") {
                EXPECT_EQ(box->currentText().toStdString(), (study / "report/models/glide/model.toml").string());
                box->setEditText(QString::fromStdString((study / "glide.toml").string()));
            }
        }
        settle(*window_);
    }
};

// A log that is dropped becomes a data set and a measurement of the study; what is missing is asked.
TEST_F(Dropped, ALogIsJudged) {
    const fs::path study = copy_of_study();
    open(study);
    const fs::path log = folder_.path() / "flight.csv";
    write_flight(log);
    auto* sheet = drop({log});
    ASSERT_NE(sheet, nullptr);
    judge_by_the_vehicle_alone(*sheet, study);
    EXPECT_EQ(sheet->field_of("gap")->currentText(), "rng_cm") << "told from the heading";
    EXPECT_EQ(sheet->unit_of("gap")->currentText(), "cm");
    EXPECT_EQ(sheet->field_of("time")->currentText(), "t_ms");
    EXPECT_EQ(sheet->unit_of("time")->currentText(), "ms");
    EXPECT_EQ(sheet->wrong(), "");
    sheet->unit_of("gap")->setEditText("");
    settle(*window_);
    EXPECT_TRUE(sheet->wrong().contains("does not say the unit of rng_cm")) << sheet->wrong().toStdString();
    sheet->unit_of("gap")->setEditText("kg");
    settle(*window_);
    EXPECT_TRUE(sheet->wrong().contains("'kg' is no unit of the gap")) << sheet->wrong().toStdString();
    sheet->unit_of("gap")->setEditText("cm");
    sheet->field_of("gap")->setEditText("rng_km");
    settle(*window_);
    EXPECT_TRUE(sheet->wrong().contains("rng_cm")) << "the nearest name: " << sheet->wrong().toStdString();
    sheet->field_of("gap")->setEditText("rng_cm");
    settle(*window_);
    ASSERT_EQ(sheet->wrong(), "");
    const Words command = sheet->command();
    const std::string before = core::read_file(study / "study.toml");
    sheet->accept();
    settle(*window_);
    EXPECT_EQ(window_->desk().state().workspace, "loop");
    EXPECT_EQ(window_->desk().state().selection, std::vector<std::string>{"measurement/flight"});
    const auto& session = window_->desk().session();
    ASSERT_EQ(session.study.measurements.size(), 1U) << window_->last_error().toStdString();
    EXPECT_NE(session.results.document("residual/flight"), nullptr) << window_->last_error().toStdString();
    EXPECT_NE(session.results.document("discovery/flight"), nullptr);
    const QString page = panel<DiscoveryPanel>().findChild<QTextBrowser*>()->toPlainText();
    EXPECT_TRUE(page.contains("flight")) << page.toStdString();
    EXPECT_TRUE(page.contains("on the data it was fitted to")) << "one run holds nothing out: " << page.toStdString();
    // The command does the same.
    const std::string written = core::read_file(study / "study.toml");
    const fs::path data = study / "measurements" / "flight" / "dataset.toml";
    const std::string set = core::read_file(data);
    core::write_file(study / "study.toml", before);
    fs::remove(data);
    const auto run = test::run_underbody({command.begin() + 1, command.end()});
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(core::read_file(study / "study.toml"), written);
    EXPECT_EQ(core::read_file(data), set);
}

// Undo takes what was written out of the study again, redo puts it back; what was changed since stays.
TEST_F(Dropped, TakingInIsUndone) {
    const fs::path study = copy_of_study();
    open(study);
    write_flight(folder_.path() / "flight.csv");
    const std::string before = core::read_file(study / "study.toml");
    const State state = window_->desk().state();
    auto* sheet = drop({folder_.path() / "flight.csv"});
    ASSERT_NE(sheet, nullptr);
    judge_by_the_vehicle_alone(*sheet, study);
    sheet->accept();
    settle(*window_);
    const std::string written = core::read_file(study / "study.toml");
    const fs::path data = study / "measurements" / "flight" / "dataset.toml";
    ASSERT_NE(written, before) << window_->last_error().toStdString();
    ASSERT_TRUE(fs::exists(data));
    EXPECT_EQ(window_->desk().history().steps().back().name, "take in flight");
    const State taken = window_->desk().state();
    window_->desk().undo();
    settle(*window_);
    EXPECT_EQ(window_->desk().state(), state) << "one step";
    EXPECT_EQ(core::read_file(study / "study.toml"), before);
    EXPECT_FALSE(fs::exists(study / "measurements"));
    EXPECT_TRUE(window_->desk().session().study.measurements.empty());
    window_->desk().redo();
    settle(*window_);
    EXPECT_EQ(window_->desk().state(), taken);
    EXPECT_EQ(core::read_file(study / "study.toml"), written);
    EXPECT_EQ(window_->desk().session().study.measurements.size(), 1U);
    EXPECT_NE(window_->desk().session().results.document("discovery/flight"), nullptr) << "computed before: reused";
    // A name that is taken: nothing is done.
    EXPECT_FALSE(
        act("measure flight model=" + (study / "glide.toml").string() + " data=" + data.parent_path().string()));
    settle(*window_);
    EXPECT_FALSE(window_->last_error().isEmpty());
    EXPECT_EQ(window_->desk().state(), taken);
    EXPECT_EQ(core::read_file(study / "study.toml"), written);
    // Lines that somebody has changed since are not taken out.
    std::string changed = written;
    changed.replace(changed.find("discover = true"), 15, "discover = false");
    core::write_file(study / "study.toml", changed);
    window_->desk().undo();
    settle(*window_);
    EXPECT_TRUE(window_->last_error().contains("have been changed since")) << window_->last_error().toStdString();
    EXPECT_EQ(core::read_file(study / "study.toml"), changed);
}

// What is cancelled, or not complete, writes nothing.
TEST_F(Dropped, NothingIsWrittenBeforeItIsTakenIn) {
    const fs::path study = copy_of_study();
    open(study);
    const std::string before = core::read_file(study / "study.toml");
    write_flight(folder_.path() / "flight.csv");
    auto* sheet = drop({folder_.path() / "flight.csv"});
    ASSERT_NE(sheet, nullptr);
    sheet->reject();
    settle(*window_);
    EXPECT_EQ(core::read_file(study / "study.toml"), before);
    EXPECT_FALSE(fs::exists(study / "measurements"));
    EXPECT_EQ(window_->desk().state().workspace, "design");
}

// Names of effects and quantities are words in what people read.
TEST(DiscoveryPage, HasNoNamesOfVariables) {
    const QString page = discovery_page(R"json({"verdict": "effect", "sentence": "The model lacks coulomb_friction.",
        "effects": [{"name": "coulomb_friction", "evidence": "told from linear_damping"}],
        "depends_on": ["heave_velocity"], "next_experiment": "to tell coulomb_friction (next-experiment.csv)"})json");
    EXPECT_FALSE(page.contains('_')) << page.toStdString();
    EXPECT_TRUE(page.contains("The model lacks coulomb friction."));
    EXPECT_TRUE(page.contains("next-experiment.csv"));
}

// The sentence and the table below it tell one number in one unit.
TEST(DiscoveryPage, TellsSmallForcesInTheUnitOfTheSentence) {
    const QString page = discovery_page(R"json({"verdict": "effect", "sentence": "friction (force 9.98 +- 0.18 mN)",
        "effects": [{"name": "coulomb_friction", "probability": 1,
                     "parameters": {"force": {"value": 0.009983, "sigma": 0.00018, "unit": "N"}}}]})json");
    EXPECT_NE(page.indexOf("force = 9.983 ± 0.18 mN"), -1) << page.toStdString();
}

TEST(DiscoveryPage, SaysWhichDataTheErrorIsOf) {
    const auto page = [](const std::string& held_out) {
        return discovery_page(
                   R"json({"verdict": "effect", "error": {"channel": "gap", "unit": "m", "held_out": ")json" +
                   held_out + R"json(", "before": {"rmse": 0.002, "low": 0.001, "high": 0.003}}})json")
            .toStdString();
    };
    EXPECT_NE(page("2 of 8 runs").find("on held-out data (2 of 8 runs)"), std::string::npos) << page("2 of 8 runs");
    const std::string fitted = page(discovery::fitted_runs);
    EXPECT_NE(fitted.find("on the data it was fitted to"), std::string::npos) << fitted;
    EXPECT_EQ(fitted.find("held"), std::string::npos) << fitted;
}

// What the command line says of a verdict stands in the window, in the same words and beside the number it is about.
TEST(DiscoveryPage, SaysWhatTheCommandSays) {
    using Severity = core::Problem::Severity;
    discovery::Discovery found;
    found.verdict = "none";
    found.structure = true;
    found.gate = 0.001;
    found.motion = "heave_pitch";
    found.held_out = "2 of 8 runs";
    found.error = {{"gap", "m", 2, {0.002, 0.001, 0.003, 8}, {0.002, 0.001, 0.003, 8}, 0.0002},
                   {"pitch", "rad", INFINITY, {0.02, 0.01, 0.03, 8}, {0.01, 0.01, 0.03, 8}, 0.001}};
    found.axes = {{"pitch_moment", "N m", 2e-4, 3e-4, 0, 5e-5, 4e-5}};
    found.limits = {{"coulomb_friction", "force", 0.004, "N"}};
    found.sentence = discovery::verdict_sentence(found);
    found.next_experiment = discovery::experiment_text("to see more", "steps of 50 mN", 0.01);
    found.problems = {{Severity::warning, "run-03 is left out: it has hardly any gap readings", {}},
                      {Severity::warning, "input_moment was not measured and is taken as zero", {}},
                      {Severity::note, "the pitch is held", {}}};
    const QString page = discovery_page(discovery::to_json(found).dump());
    for (const char* words :
         {"No effect is named", "is taken as zero", "run-03 is left out", "the pitch is held",
          "Error of gap over 2 s on held-out data (2 of 8 runs): <b>2 (1 … 3)</b> mm", "Error of pitch in free run",
          "noise 20 → 10", "The model lacks of pitch moment: 0.0003 N m", "coulomb friction: force", "4 mN",
          "no experiment of this kind on this rig settles it"}) {
        EXPECT_TRUE(page.contains(words)) << words << "\n" << page.toStdString();
    }
    EXPECT_LT(page.indexOf("taken as zero"), page.indexOf("Error of gap")) << "before the number that it is about";
    EXPECT_GT(page.indexOf("the pitch is held"), page.indexOf("no experiment of this kind"));
}

// Without a study there is no model to judge by: a sentence, and no sheet.
TEST_F(Dropped, ALogWithoutAStudyIsASentence) {
    write_flight(folder_.path() / "flight.csv");
    window_->take_files({folder_.path() / "flight.csv"});
    settle(*window_);
    EXPECT_TRUE(window_->last_error().contains("open the study first")) << window_->last_error().toStdString();
    EXPECT_EQ(window_->findChild<MeasurementSheet*>(), nullptr);
}

// The shipped measurement is a data set: nothing is asked, and its folder or its dataset.toml are the same.
TEST_F(Dropped, ADataSetSaysItselfWhatItHolds) {
    open(computed_study());
    for (const fs::path& given : {test::source_folder() / "cases" / "evie" / "heave",
                                  test::source_folder() / "cases" / "evie" / "heave" / "dataset.toml"}) {
        auto* sheet = drop({given});
        ASSERT_NE(sheet, nullptr);
        EXPECT_EQ(sheet->wrong(), "") << given;
        const Words command = sheet->command();
        EXPECT_EQ(std::count(command.begin(), command.end(), "--channel"), 0);
        delete sheet;
    }
}

// Vehicles' logs are told by their content, whatever they are called, and list their fields.
TEST_F(Dropped, LogsOfVehiclesListTheirFields) {
    const fs::path logs = test::source_folder().parent_path() / "shared" / "samples" / "logs";
    if (!fs::exists(logs)) {
        GTEST_SKIP() << "skipped: " << logs << " is not there";
    }
    open(computed_study());
    const std::map<std::string, std::pair<const char*, const char*>> known = {
        {"ardusub_small.BIN", {"BARO/Alt", "m"}}, {"sample_log_small.ulg", {"vehicle_local_position/z", ""}}};
    for (const auto& [name, field] : known) {
        const fs::path renamed = folder_.path() / (name.substr(0, 4) + ".dat");
        fs::copy_file(logs / name, renamed);
        auto* sheet = drop({renamed});
        ASSERT_NE(sheet, nullptr) << name;
        EXPECT_GE(sheet->field_of("gap")->findText(field.first), 0) << name;
        sheet->field_of("gap")->setEditText(field.first);
        settle(*window_);
        if (std::string(field.second).empty()) {  // the log does not say it: it is asked
            EXPECT_TRUE(sheet->wrong().contains("does not say the unit")) << sheet->wrong().toStdString();
            sheet->unit_of("gap")->setEditText("m");
            settle(*window_);
        }
        EXPECT_FALSE(sheet->wrong().contains("unit")) << name << ": " << sheet->wrong().toStdString();
        delete sheet;
    }
}

// A damaged log says why; the window goes on.
TEST_F(Dropped, ADamagedLogSaysWhy) {
    open(computed_study());
    const fs::path log = folder_.path() / "cut.ulg";
    core::write_file(log, std::string("ULog\x01\x12\x35\x01", 8) + std::string(8, '\0') + "nonsense");
    auto* sheet = drop({log});
    ASSERT_NE(sheet, nullptr);
    EXPECT_FALSE(sheet->wrong().isEmpty());
    EXPECT_NE(sheet->wrong(), "looking at the data");
}

// As a file manager drops: events of the system's window, which finds what is under the mouse. Nothing that is there
// keeps a file for itself.
TEST_F(Dropped, FilesAreTakenWhereverTheyFall) {
    open(computed_study());
    const fs::path fields = test::source_folder() / "cases" / "evie" / "fields";
    const auto fall = [&](const std::vector<fs::path>& files, QWidget* on) {
        QMimeData data;
        QList<QUrl> urls;
        QString text;
        for (const auto& file : files) {
            urls << QUrl::fromLocalFile(QString::fromStdString(file.string()));
            text += QString::fromStdString(file.string()) + "\n";
        }
        data.setUrls(urls);
        data.setText(text);  // file managers say it in words, too
        ASSERT_TRUE(on->isVisible());
        const QPoint at = on->mapTo(window_.get(), on->rect().center());
        QDragEnterEvent enter(at, Qt::CopyAction | Qt::MoveAction, &data, Qt::LeftButton, Qt::ShiftModifier);
        QApplication::sendEvent(window_->windowHandle(), &enter);
        EXPECT_TRUE(enter.isAccepted());
        QDragMoveEvent move(at, Qt::CopyAction | Qt::MoveAction, &data, Qt::LeftButton, Qt::ShiftModifier);
        move.setDropAction(enter.dropAction());  // as Qt hands them on
        move.accept();
        QApplication::sendEvent(window_->windowHandle(), &move);
        EXPECT_TRUE(move.isAccepted());
        QDropEvent drop(at, Qt::CopyAction | Qt::MoveAction, &data, Qt::LeftButton, Qt::ShiftModifier);
        QApplication::sendEvent(window_->windowHandle(), &drop);
        EXPECT_TRUE(drop.isAccepted());
        EXPECT_EQ(drop.dropAction(), Qt::CopyAction) << "a file manager would delete what was moved";
        settle(*window_);
    };
    QLineEdit* filter = nullptr;
    for (auto* edit : window_->findChildren<QLineEdit*>()) {
        filter = edit->accessibleName() == "Filter the study" ? edit : filter;
    }
    ASSERT_NE(filter, nullptr);
    fall({fields / "ellipse-h2-p0.csv"}, filter);
    EXPECT_EQ(filter->text(), "") << "no text falls into a field";
    EXPECT_EQ(window_->desk().state().workspace, "compare");
    EXPECT_EQ(panel<FieldsPanel>().drawn(), 1U);

    core::write_file(folder_.path() / "damaged.csv", "[Name]\nbase\n[Data]\nX [ m ],Y [ m ]\n1,2,3\n");
    fall({fields / "ellipse-h3-p0.csv", folder_.path() / "damaged.csv", fields / "ellipse-h20-p0.csv"},
         &panel<FieldsPanel>());
    EXPECT_EQ(panel<FieldsPanel>().drawn(), 2U);
    EXPECT_TRUE(panel<FieldsPanel>().failed(1).contains("damaged.csv")) << panel<FieldsPanel>().failed(1).toStdString();

    fs::create_directories(folder_.path() / "run7");
    fs::copy_file(fields / "ellipse-h2-p0.csv", folder_.path() / "run7" / "run7_h2mm_p0.csv");
    fs::copy_file(fields / "ellipse-h3-p0.csv", folder_.path() / "run7" / "run7_h3mm_p0.csv");
    fall({folder_.path() / "run7"}, window_->findChild<StudyTree*>()->viewport());
    auto* sheet = window_->findChild<TakeInSheet*>();
    ASSERT_NE(sheet, nullptr);
    const auto labels = sheet->findChildren<QLabel*>();
    EXPECT_TRUE(std::any_of(labels.begin(), labels.end(), [](const QLabel* label) {
        return label->text().contains("a half model? then choose 'half, its plane across y' below");
    })) << "what the sheet calls it, not the command";
    sheet->reject();
    settle(*window_);

    write_flight(folder_.path() / "flight.csv");
    fall({folder_.path() / "flight.csv"}, window_->findChild<ProblemList*>()->viewport());
    EXPECT_NE(window_->findChild<MeasurementSheet*>(), nullptr);
}

}  // namespace
}  // namespace underbody::studio
