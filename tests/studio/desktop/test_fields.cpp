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
#include <QStyleOption>
#include <QTableWidget>
#include <QTest>

#include "cases/case_loads.h"
#include "core/text.h"
#include "studio/desktop/compare_numbers.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/region_panel.h"
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
    EXPECT_EQ(sheet->files()->item(0, 0)->text(), "deep/run7_h20mm_p0.csv");
    EXPECT_EQ(sheet->files()->item(0, 1)->text(), "20");
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
