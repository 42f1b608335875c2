// Fields from outside a study in the real window: what they do not say is asked, a damaged one says why, a folder
// becomes cases of a study, planes and streamlines stand in the place of surfaces.
// clang-format off
#include "studio/desktop/region_known.h"
#include "surrogates/dynamics/basin/region.h"
#include "cases/region_model.h"
// clang-format on

#include <gtest/gtest.h>

#include <QApplication>
#include <QComboBox>
#include <QLineEdit>
#include <QListWidget>
#include <QPainter>
#include <QPushButton>
#include <QStyleOption>
#include <QTableWidget>
#include <QTest>
#include <QToolButton>

#include "cases/case_loads.h"
#include "core/text.h"
#include "postproc/probe/probe.h"
#include "studio/desktop/compare_numbers.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/region_panel.h"
#include "studio/desktop/table_sheet.h"
#include "studio/desktop/take_in_sheet.h"
#include "studio/desktop/theme.h"
#include "studio/desktop/unit_sheet.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

fs::path shipped(const std::string& name) { return test::source_folder() / "cases" / "evie" / "fields" / name; }

std::string without_units(std::string text) {
    for (const char* unit : {" [ m ]", " [ Pa ]", " [m]", " [Pa]"}) {
        for (auto at = text.find(unit); at != std::string::npos; at = text.find(unit)) {
            text.erase(at, std::string(unit).size());
        }
    }
    return text;
}

double lift_shown(FieldsPanel& fields) { return fields.numbers()->table().numbers("lift_force").at(0); }

// Velocity is the first array of a solver's case, and nought on every wall: its pressure is shown, whatever it is
// called.
TEST_F(Window, ACaseOfASolverShowsItsPressureFirst) {
    window_->take_files({test::data_folder() / "openfoam" / "ascii"});
    settle(*window_);
    ASSERT_TRUE(window_->last_error().isEmpty()) << window_->last_error().toStdString();
    for (auto* choice : panel<FieldsPanel>().findChildren<QComboBox*>()) {
        if (choice->accessibleName() == "Colour by") {
            EXPECT_EQ(choice->currentText(), "kinematic pressure");
            EXPECT_GT(choice->currentIndex(), 0) << "the case no longer tests it";
        }
    }
}

// Boxes to tick have a rim that is seen in either theme, in lists too.
TEST_F(Window, BoxesToTickAreSeen) {
    const std::unique_ptr<QStyle> style(window_style());
    for (const char* theme : {"light", "dark"}) {
        set_theme(theme);
        QStyleOptionViewItem option;
        option.rect = QRect(0, 0, 14, 14);
        option.palette = QApplication::palette();
        for (const auto element : {QStyle::PE_IndicatorCheckBox, QStyle::PE_IndicatorItemViewItemCheck}) {
            QImage image(14, 14, QImage::Format_RGB32);
            const QColor ground = option.palette.color(QPalette::Base);
            image.fill(ground);
            QPainter painter(&image);
            style->drawPrimitive(element, &option, &painter, nullptr);
            painter.end();
            EXPECT_GT(std::abs(qGray(image.pixel(0, 7)) - qGray(ground.rgb())), 60) << theme;
        }
    }
    set_theme("system");
}

// A file whose units are not said is asked for, not failed; the answer is one action, undone as any other.
TEST_F(Window, UnitsThatAFileDoesNotSayAreAsked) {
    const fs::path file = folder_.path() / "bare.csv";
    core::write_file(file, without_units(core::read_file(shipped("ellipse-h5-p0.csv"))));
    window_->take_files({file});
    settle(*window_);
    auto& fields = panel<FieldsPanel>();
    EXPECT_TRUE(window_->last_error().isEmpty()) << "asked, not failed: " << window_->last_error().toStdString();
    EXPECT_TRUE(fields.failed(0).contains("has no unit")) << fields.failed(0).toStdString();
    UnitSheet& sheet = fields.unit_sheet();
    ASSERT_TRUE(sheet.isVisible());
    ASSERT_EQ(sheet.files(), std::vector<fs::path>{file});
    EXPECT_TRUE(sheet.words().empty()) << "nothing is chosen unasked";
    for (auto* choice : sheet.findChildren<QComboBox*>()) {
        if (choice->isEditable()) {
            choice->setCurrentText(choice->accessibleName() == "Unit of the coordinates" ? "m" : "Pa");
        }
        if (choice->accessibleName() == "Half model") {
            choice->setCurrentIndex(choice->findData("y"));
        }
    }
    ASSERT_FALSE(sheet.words().empty());
    sheet.accept();
    settle(*window_);
    EXPECT_FALSE(sheet.isVisible());
    EXPECT_EQ(fields.failed(0), "");
    EXPECT_EQ(fields.drawn(), 1U);
    postproc::LoadsOptions options;
    options.symmetry = "y";
    postproc::ReadOptions reading;
    reading.surfaces_only = true;
    const double lift =
        postproc::loads(postproc::read_field(shipped("ellipse-h5-p0.csv"), reading), options).named.lift_force;
    EXPECT_DOUBLE_EQ(lift_shown(fields), lift);
    const auto& step = window_->desk().history().steps().back();
    EXPECT_EQ(step.command.substr(0, 15), "underbody loads");
    EXPECT_NE(step.command.find("--length-unit m"), std::string::npos) << step.command;
    EXPECT_NE(step.command.find("--symmetry y"), std::string::npos) << step.command;
    // In another unit it is another body.
    act("read " + file.string() + " length_unit=mm");
    settle(*window_);
    EXPECT_NEAR(lift_shown(fields), 1e-6 * lift, 1e-9 * std::abs(lift));
    window_->desk().undo();
    settle(*window_);
    EXPECT_DOUBLE_EQ(lift_shown(fields), lift);
    EXPECT_FALSE(act("read " + file.string() + " length_unit=Pa"));
    EXPECT_NE(window_->last_error().indexOf("no unit of a length"), -1) << window_->last_error().toStdString();
}

TEST_F(Window, ADamagedFileSaysWhyAndTheOthersGoOn) {
    const fs::path damaged = folder_.path() / "damaged.csv";
    const std::string whole = core::read_file(shipped("ellipse-h2-p0.csv"));
    core::write_file(damaged, whole.substr(0, whole.size() / 3));
    window_->take_files({damaged, shipped("ellipse-h1-p0.csv"), shipped("ellipse-h100-p0.csv")});
    settle(*window_);
    auto& fields = panel<FieldsPanel>();
    EXPECT_EQ(fields.drawn(), 2U);
    EXPECT_FALSE(fields.failed(0).isEmpty());
    EXPECT_TRUE(fields.failed(1).isEmpty());
    EXPECT_EQ(fields.said(0), fields.failed(0)) << "where the picture would be";
    EXPECT_NE(window_->last_error().indexOf("cut short"), -1) << window_->last_error().toStdString();
    EXPECT_TRUE(std::isnan(fields.numbers()->table().numbers("lift_force").at(0)));
    EXPECT_FALSE(std::isnan(fields.numbers()->table().numbers("lift_force").at(1)));
}

// A half model that is a surface alone (no symmetry boundary says so): its loads are half of what they seem, which the
// command line told and the window did not.
TEST_F(Window, AnOpenHalfIsSaidAndTaken) {
    window_->take_files({shipped("ellipse-h5-p0.csv")});
    settle(*window_);
    auto& fields = panel<FieldsPanel>();
    const double half = lift_shown(fields);
    EXPECT_TRUE(window_->findChild<ProblemList*>()->text().contains("half of a model? then 'Half model across y"))
        << window_->findChild<ProblemList*>()->text().toStdString();
    QPushButton* offer = nullptr;
    for (auto* button : fields.findChildren<QPushButton*>()) {
        offer = button->text().startsWith("Half model across y") ? button : offer;
    }
    ASSERT_TRUE(offer != nullptr && offer->isVisible());
    offer->click();
    settle(*window_);
    EXPECT_NEAR(lift_shown(fields), 2 * half, 1e-3 * std::abs(half));
    EXPECT_FALSE(offer->isVisible());
}

// More files than can stand beside each other: they were added in the order of their letters, six were shown, and
// nothing was said of the others.
TEST_F(Window, ManyFilesAreTakenInAsCases) {
    const fs::path folder = folder_.path() / "exports";
    fs::create_directories(folder);
    std::vector<fs::path> files;
    for (const char* gap : {"10", "1", "20", "2", "3", "50", "5"}) {
        files.push_back(folder / (std::string("run7_h") + gap + "mm.csv"));
        fs::copy_file(shipped(std::string("ellipse-h") + gap + "-p0.csv"), files.back());
    }
    window_->take_files(files);
    settle(*window_);
    auto* sheet = window_->findChild<TakeInSheet*>();
    ASSERT_NE(sheet, nullptr);
    EXPECT_EQ(sheet->pattern()->text(), "run7_h{gap:mm}mm.csv");
    ASSERT_EQ(sheet->files()->rowCount(), 7);
    EXPECT_EQ(sheet->files()->item(0, 1)->text(), "1");
    EXPECT_EQ(sheet->files()->item(6, 1)->text(), "50");
    EXPECT_TRUE(window_->desk().state().files.empty());
    sheet->reject();
    // Six stand beside each other; once they are cases they are no files from outside any more.
    files.pop_back();
    window_->take_files(files);
    settle(*window_);
    EXPECT_EQ(window_->desk().state().files.size(), 6U);
    EXPECT_EQ(window_->desk().state().workspace, "compare");
    sheet = window_->take_in(files);
    settle(*window_);
    sheet->half()->setCurrentIndex(sheet->half()->findData("y"));
    sheet->accept();
    settle(*window_);
    ASSERT_TRUE(window_->has_study()) << window_->last_error().toStdString();
    EXPECT_TRUE(window_->desk().state().files.empty());
}

// J1 goes on to a table: what the sheet says is what `study add --table` does.
TEST_F(Window, CasesBecomeATableOfForces) {
    const fs::path folder = folder_.path() / "exports";
    for (const char* name : {"ellipse-h2-p0", "ellipse-h5-p0", "ellipse-h20-p0", "ellipse-h5-p1"}) {
        fs::create_directories(folder);
        fs::copy_file(shipped(std::string(name) + ".csv"), folder / (std::string(name) + ".csv"));
    }
    fs::copy_file(shipped("ellipse-h5-p0.csv"), folder / "other-h5-p0.csv");
    core::write_file(folder / "study.toml",
                     "title = \"exports\"\n\n[frame]\nsymmetry = \"y\"\n\n[[case]]\n"
                     "files = \"{variant}-h{gap:mm}-p{pitch:deg}.csv\"\nconditions = { speed = \"0.5 m/s\" }\n");
    window_->open_study(folder);
    settle(*window_);
    auto* sheet = window_->make_table();
    EXPECT_EQ(sheet->quantity()->findText("side_force"), -1) << "halves cancel it";
    EXPECT_EQ(sheet->held()->text(), "pitch=0 deg,variant=ellipse") << "the fullest curve over the gap";
    EXPECT_EQ(sheet->axes()->text(), "gap");
    EXPECT_EQ(sheet->wrong(), "");
    sheet->held()->setText("pitch=O deg");
    EXPECT_NE(sheet->wrong(), "");
    sheet->net_weight()->setText("3mm");
    sheet->held()->setText("variant=ellipse,pitch=0deg");
    EXPECT_TRUE(sheet->wrong().contains("another dimension")) << sheet->wrong().toStdString();
    sheet->net_weight()->clear();
    sheet->held()->setText("variant=ellipse");
    EXPECT_TRUE(sheet->wrong().contains("differ in pitch")) << sheet->wrong().toStdString();
    sheet->held()->setText("variant=ellipse,pitch=0deg");
    sheet->net_weight()->setText("0.2N");
    ASSERT_EQ(sheet->wrong(), "");
    const Words command = sheet->command();
    sheet->accept();
    settle(*window_);
    EXPECT_EQ(window_->last_error(), "");
    const auto& tables = window_->desk().session().study.tables;
    ASSERT_EQ(tables.size(), 1U);
    EXPECT_EQ(tables[0].name, "lift");
    EXPECT_EQ(window_->desk().state().workspace, "tables");
    EXPECT_EQ(window_->desk().session().results.tables.size(), 1U) << "computed";
    const std::string written = core::read_file(folder / "study.toml");
    core::write_file(folder / "study.toml", written.substr(0, written.find("\n[[table]]")));
    const test::ProgramRun same = test::run_underbody({command.begin() + 1, command.end()}, folder);
    EXPECT_EQ(same.exit_code, 0) << same.errors;
    EXPECT_EQ(core::read_file(folder / "study.toml"), written) << "the command line does the same";
}

// J1: a folder with names that carry conditions becomes cases; what the sheet says is what `study add` does.
TEST_F(Window, AFolderOfFilesBecomesCasesOfAStudy) {
    const fs::path folder = folder_.path() / "exports";
    fs::create_directories(folder / "deep");
    for (const char* gap : {"2", "5", "20"}) {
        core::write_file(folder / "deep" / (std::string("run7_h") + gap + "mm_p0.csv"),
                         without_units(core::read_file(shipped(std::string("ellipse-h") + gap + "-p0.csv"))));
    }
    core::write_file(folder / "notes.txt", "not CFD");
    const std::string whole = core::read_file(shipped("ellipse-h3-p0.csv"));
    core::write_file(folder / "deep" / "run7_h3mm_p0.csv", without_units(whole.substr(0, whole.size() / 3)));
    window_->take_files({folder});
    settle(*window_);
    auto* sheet = window_->findChild<TakeInSheet*>();
    ASSERT_NE(sheet, nullptr);
    EXPECT_EQ(sheet->pattern()->text(), "deep/run7_h{gap:mm}mm_p{pitch:deg}.csv");
    EXPECT_EQ(sheet->files()->rowCount(), 4);
    EXPECT_EQ(sheet->files()->item(0, 0)->text(), "deep/run7_h2mm_p0.csv") << "2 before 20";
    EXPECT_EQ(sheet->files()->item(0, 1)->text(), "2");
    EXPECT_TRUE(sheet->wrong().contains("unit")) << sheet->wrong().toStdString();
    ASSERT_GE(sheet->units().size(), 2U);
    for (auto* choice : sheet->units()) {
        choice->setCurrentText(choice->accessibleName() == "Unit of the coordinates" ? "m" : "Pa");
    }
    sheet->half()->setCurrentIndex(sheet->half()->findData("y"));
    sheet->conditions()->setText("sped=0.5m/s");
    EXPECT_TRUE(sheet->wrong().contains("speed")) << sheet->wrong().toStdString();
    sheet->conditions()->setText("speed=0.5m/s");
    EXPECT_EQ(sheet->wrong(), "");
    const Words command = sheet->command();
    EXPECT_EQ(line_of(command).substr(0, 19), "underbody study add");
    sheet->accept();
    settle(*window_);
    ASSERT_TRUE(window_->has_study()) << window_->last_error().toStdString();
    EXPECT_EQ(window_->desk().session().study.cases.size(), 4U);
    EXPECT_EQ(window_->desk().session().results.loads.rows(), 3U) << "the damaged one is told, the others are computed";
    EXPECT_TRUE(window_->findChild<ProblemList*>()->text().contains("run7_h3mm_p0")) << "told by its name";
    EXPECT_EQ(window_->desk().state().workspace, "compare") << "a picture comes first";
    const std::string written = core::read_file(folder / "study.toml");
    fs::remove(folder / "study.toml");
    const auto run = test::run_underbody({command.begin() + 1, command.end()});
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(core::read_file(folder / "study.toml"), written) << "the command does the same";
}

TEST_F(Window, APlaneThatAFileDoesNotHoldIsSaid) {
    open(computed_study());
    act("select case/ellipse-h5-p0");
    act("workspace compare");
    act("fields view=speed-symmetry");
    settle(*window_);
    EXPECT_TRUE(panel<FieldsPanel>().said(0).contains("does not allow speed-symmetry"))
        << panel<FieldsPanel>().said(0).toStdString();
    EXPECT_TRUE(panel<FieldsPanel>().said(0).contains("pressure-underbody"));
    EXPECT_FALSE(act("fields view=speed-symetry"));
    EXPECT_NE(window_->last_error().indexOf("did you mean 'speed-symmetry'"), -1);
    EXPECT_NE(window_->desk().history().steps().back().command.find("--view speed-symmetry"), std::string::npos);
}

// What the sensors can know along the gap is the library's, and follows the sensors' noise.
TEST_F(Window, TheEstimatorSaysWhatItCanSeparateAlongTheGap) {
    open(computed_study());
    act("workspace stability");
    act("region glide show=estimator gap_noise=0.1mm drag_error=0.3");
    settle(*window_);
    auto& stability = panel<RegionPanel>();
    ASSERT_TRUE(stability.known()) << window_->last_error().toStdString();
    const auto& study = window_->desk().session().study;
    const auto model = cases::region_model(study, study.regions.front(), window_->desk().session().results).resolved();
    estimator::InformationOptions options;
    options.noise.gap = 1e-4;
    options.noise.drag_relative = options.drag_prior = 0.3;
    const auto map = estimator::information_along_gap(estimator::separate(model, model.conditions), options);
    const auto shown = stability.known();
    EXPECT_EQ(shown->information.ground_sigma, map.ground_sigma);
    EXPECT_EQ(shown->information.blind_share, map.blind_share);
    for (const auto rank : shown->observability.separate_rank) {
        EXPECT_EQ(rank, 1U) << "the motion shows one combination of two forces";
    }
    const core::Table table = map.table();
    EXPECT_EQ(table.rows(), map.gaps.size() * map.speeds.size());
    EXPECT_EQ(table.numbers("total_force_sigma"), map.total_sigma);
    EXPECT_EQ(map.along_gap(0.01).curves.size(), 4U);
    act("region glide gap_noise=2mm");
    settle(*window_);
    EXPECT_GT(stability.known()->information.total_sigma[30], map.total_sigma[30]) << "a worse sensor knows less";
    window_->desk().undo();
    settle(*window_);
    EXPECT_NE(stability.known(), shown);
    EXPECT_FALSE(act("region glide gap_noise=0"));
}

QListWidgetItem* zone_item(FieldsPanel& fields, const QString& name) {
    for (auto* list : fields.findChildren<QListWidget*>()) {
        const auto items = list->findItems(name, Qt::MatchExactly);
        if (list->accessibleName() == "Zones" && !items.isEmpty()) {
            return items.front();
        }
    }
    return nullptr;
}

template <class Widget>
Widget* named(QWidget& in, const QString& name) {
    for (auto* one : in.findChildren<Widget*>()) {
        if (one->accessibleName() == name) {
            return one;
        }
    }
    return nullptr;
}

/// An OpenFOAM case with three times, whose pressure is that of the test's own times one, two and three.
fs::path case_of_three_times(const fs::path& folder) {
    const fs::path foam = folder / "foam";
    fs::copy(test::data_folder() / "openfoam" / "ascii", foam, fs::copy_options::recursive);
    fs::path last;
    double latest = -1;
    for (const auto& entry : fs::directory_iterator(foam)) {
        if (const auto time = core::parse_number(entry.path().filename().string()); time && *time > latest) {
            latest = *time;
            last = entry.path();
        }
    }
    for (const char* later : {"7", "8.5"}) {
        fs::copy(last, foam / later, fs::copy_options::recursive);
    }
    return foam;
}

// The name that a file gives an array is as good as the label that people read.
TEST_F(Window, AnArrayIsNamedByItsOwnNameToo) {
    open(computed_study());
    act("select case/ellipse-h5-p0");
    act("workspace compare");
    settle(*window_);
    EXPECT_TRUE(act("fields array=wall_shear"));
    settle(*window_);
    EXPECT_EQ(named<QComboBox>(panel<FieldsPanel>(), "Colour by")->currentText(), "wall shear");
    EXPECT_EQ(window_->last_error(), "");
    act("fields array=wall_sheer");
    settle(*window_);
    EXPECT_TRUE(window_->last_error().contains("did you mean 'wall shear'")) << window_->last_error().toStdString();
}

// Times of a transient case: a list of them, one step earlier or later, by hand or as an action; undone as any other.
TEST_F(Window, TimesAreSteppedThrough) {
    window_->take_files({case_of_three_times(folder_.path())});
    settle(*window_);
    ASSERT_TRUE(window_->last_error().isEmpty()) << window_->last_error().toStdString();
    auto& fields = panel<FieldsPanel>();
    auto* time = named<QComboBox>(fields, "Time");
    auto* earlier = named<QToolButton>(fields, "Earlier");
    auto* later = named<QToolButton>(fields, "Later");
    ASSERT_TRUE(time != nullptr && earlier != nullptr && later != nullptr);
    ASSERT_TRUE(time->isVisible());
    ASSERT_GE(time->count(), 3);
    EXPECT_EQ(time->itemText(time->count() - 1), "8.5 s");
    EXPECT_EQ(time->currentText(), "") << "the last";
    earlier->click();
    settle(*window_);
    EXPECT_EQ(window_->desk().state().fields.time, 7.0);
    EXPECT_EQ(time->currentText(), "7 s");
    EXPECT_EQ(fields.drawn(), 1U);
    later->click();
    later->click();
    settle(*window_);
    EXPECT_EQ(window_->desk().state().fields.time, 8.5) << "there is none after the last";
    window_->desk().undo();
    settle(*window_);
    EXPECT_FALSE(window_->desk().state().fields.time);
    act("fields time=99s");
    settle(*window_);
    EXPECT_TRUE(fields.failed(0).contains("no time 99 s")) << fields.failed(0).toStdString();
}

// What is read off at a place is what the library's probe gives there, of every case that is shown.
TEST_F(Window, ValuesAreReadOffAtAPlace) {
    open(computed_study());
    act("select case/ellipse-h5-p0 case/ellipse-h2-p0");
    act("workspace compare");
    settle(*window_);
    auto& fields = panel<FieldsPanel>();
    EXPECT_EQ(fields.probed(), "");
    EXPECT_TRUE(act("fields probe=10mm,5mm,0"));
    settle(*window_);
    postproc::ReadOptions reading;
    reading.surfaces_only = true;
    postproc::ProbeOptions on;
    on.on_surface = true;
    on.zones = {"base"};
    for (const char* gap : {"5", "2"}) {
        const auto field = postproc::read_field(shipped(std::string("ellipse-h") + gap + "-p0.csv"), reading);
        const auto table = postproc::probe_points(field, {{0.01, 0.005, 0}}, on);
        const QString value = QString::fromStdString(core::format_number(table.numbers("pressure").front(), 5));
        EXPECT_TRUE(fields.probed().contains("pressure " + QString(value).replace('-', QChar(0x2212)) + " Pa"))
            << fields.probed().toStdString() << "\n"
            << value.toStdString();
    }
    EXPECT_NE(window_->desk().history().steps().back().command.find("underbody probe "), std::string::npos);
    const auto run = test::run_underbody([&] {
        const Words words = words_of(window_->desk().history().steps().back().command);
        return std::vector<std::string>(words.begin() + 1, words.end());
    }());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_FALSE(act("fields probe=10mm,5mm"));
    EXPECT_TRUE(act("fields probe="));
    settle(*window_);
    EXPECT_EQ(fields.probed(), "");
}

// Zones of the body are marked one by one; the loads follow, and undo takes it back.
TEST_F(Window, ZonesOfTheBodyAreMarked) {
    window_->take_files({shipped("ellipse-h5-p0.csv")});
    settle(*window_);
    auto& fields = panel<FieldsPanel>();
    ASSERT_NE(zone_item(fields, "base"), nullptr);
    act("read " + shipped("ellipse-h5-p0.csv").string() + " symmetry=y");
    settle(*window_);
    const double whole = lift_shown(fields);
    fields.mark_zone(0, "base", false);
    settle(*window_);
    EXPECT_EQ(window_->last_error(), "");
    const auto& said = window_->desk().state().readings.at(shipped("ellipse-h5-p0.csv").string());
    EXPECT_FALSE(said.zones.empty());
    EXPECT_EQ(std::count(said.zones.begin(), said.zones.end(), "base"), 0);
    EXPECT_NE(window_->desk().history().steps().back().command.find("--zones "), std::string::npos);
    EXPECT_FALSE(lift_shown(fields) == whole);
    fields.mark_zone(0, "base", true);
    settle(*window_);
    EXPECT_NEAR(lift_shown(fields), whole, 1e-12);
    window_->desk().go_to(window_->desk().history().position() - 2);
    settle(*window_);
    EXPECT_DOUBLE_EQ(lift_shown(fields), whole);
}

// A case over density without one says so where its forces would stand; the density is asked with the units.
TEST_F(Window, ADensityIsAskedWhereAFileNeedsOne) {
    const fs::path foam = folder_.path() / "foam";
    fs::copy(test::data_folder() / "openfoam" / "ascii", foam, fs::copy_options::recursive);
    std::string control = core::read_file(foam / "system" / "controlDict");
    for (auto at = control.find("rhoInf 998; "); at != std::string::npos; at = control.find("rhoInf 998; ")) {
        control.erase(at, 12);
    }
    core::write_file(foam / "system" / "controlDict", control);
    window_->take_files({foam});
    settle(*window_);
    auto& fields = panel<FieldsPanel>();
    ASSERT_EQ(fields.drawn(), 1U) << fields.failed(0).toStdString();
    ASSERT_TRUE(std::isnan(lift_shown(fields)));
    auto* forces = fields.numbers()->forces();
    EXPECT_TRUE(forces->item(0, 0)->text().contains("density")) << forces->item(0, 0)->text().toStdString();
    EXPECT_EQ(fields.numbers()->rows().at(1).at(1), "–") << "a sheet has no room for it";
    EXPECT_TRUE(act("read " + foam.string() + " density=1000kg/m^3"));
    settle(*window_);
    const double lift = lift_shown(fields);
    EXPECT_TRUE(std::isfinite(lift));
    act("read " + foam.string() + " density=500kg/m^3");
    settle(*window_);
    EXPECT_NEAR(lift_shown(fields), lift / 2, 1e-9 * std::abs(lift));
    EXPECT_NE(window_->desk().history().steps().back().command.find("500kg/m^3"), std::string::npos);
    EXPECT_FALSE(act("read " + foam.string() + " density=-1kg/m^3"));
}

// The flow over the gap's height stands among what can be shown; a file without a volume says what it lacks.
TEST_F(Window, TheGapProfileIsAmongTheViews) {
    open(computed_study());
    act("select case/ellipse-h5-p0");
    act("workspace compare");
    EXPECT_GE(named<QComboBox>(panel<FieldsPanel>(), "Show")->findData("profile-gap"), 0);
    EXPECT_TRUE(act("fields view=profile-gap"));
    settle(*window_);
    EXPECT_TRUE(panel<FieldsPanel>().said(0).contains("needs a volume")) << panel<FieldsPanel>().said(0).toStdString();
    EXPECT_NE(window_->desk().history().steps().back().command.find("--view profile-gap"), std::string::npos);
}

// A place shows its name alone; its folders stand in the tip and in what is copied.
TEST_F(Window, ProblemsShowNamesAndKeepPaths) {
    auto* problems = window_->findChild<ProblemList*>();
    ASSERT_NE(problems, nullptr);
    const std::string file = (fs::temp_directory_path() / "underbody-x1" / "lift_force-1.csv").string();
    problems->add({core::Problem::Severity::warning, "the table in " + file + " is short", {file, 3, {}, {}}});
    const auto* row = problems->topLevelItem(problems->topLevelItemCount() - 1);
    EXPECT_EQ(row->text(2), "lift_force-1.csv:3");
    EXPECT_EQ(row->text(1), "the table in lift_force-1.csv is short");
    EXPECT_TRUE(row->toolTip(2).contains(QString::fromStdString(file)));
    EXPECT_TRUE(problems->text().contains(QString::fromStdString(file) + ":3"));
}

// Titles of three lines ("pitch moment (N m)") were cut between near axes.
TEST_F(Window, TitlesOverParallelAxesHaveTheirRoom) {
    ParallelView view(nullptr);
    view.resize(700, 300);
    std::vector<ParallelView::Axis> axes;
    for (int i = 0; i < 9; ++i) {
        ParallelView::Axis axis;
        axis.name = "a" + std::to_string(i);
        axis.title = i == 4 ? "pitch moment of the half model (N m)" : "gap (mm)";
        axis.values = {1, 2, 3};
        axes.push_back(axis);
    }
    view.show_axes(axes);
    view.show();
    const QRect needed = view.fontMetrics().boundingRect(QRect(0, 0, (700 - 120) / 8 - 4, 1000),
                                                         Qt::AlignHCenter | Qt::TextWordWrap, axes[4].title);
    EXPECT_GT(needed.height(), 40) << "three lines at least";
    EXPECT_GE(view.head() - 26, needed.height());
}

}  // namespace
}  // namespace underbody::studio
