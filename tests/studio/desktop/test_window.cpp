// The real window, driven without a display (Qt's `offscreen` platform; 3D is tested by the pictures of test_desktop).
// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "surrogates/dynamics/basin/region.h"
// clang-format on

#include <gtest/gtest.h>

#include <QAbstractSpinBox>
#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QLabel>
#include <QLineEdit>
#include <QMenuBar>
#include <QMouseEvent>
#include <QSettings>
#include <QSlider>
#include <QStandardPaths>
#include <QStatusBar>
#include <QTableWidget>
#include <QTest>
#include <cmath>
#include <fstream>
#include <future>
#include <random>
#include <thread>

#include "core/text.h"
#include "geometry/body/body_report.h"
#include "studio/desktop/compare_numbers.h"
#include "studio/desktop/design_panel.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/region_panel.h"
#include "studio/desktop/screenshots.h"
#include "studio/desktop/state/words.h"
#include "studio/desktop/study_tree.h"
#include "studio/figures/render.h"
#include "surrogates/tables/fit/force_table.h"
#include "tests/studio/desktop/heartbeat.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

TEST_F(Window, EveryActionIsDoneUndoneAndRedone) {
    open(computed_study());
    const std::vector<std::string> lines = {"select case/ellipse-h5-p0 case/ellipse-h2-p0",
                                            "star case/ellipse-h5-p0",
                                            "workspace design",
                                            "set 'protrusion.height=1.5 mm'",
                                            "pin",
                                            "keep two",
                                            "forget two",
                                            "operation gap=3mm pitch=1deg",
                                            "workspace explore",
                                            "axes gap drag_force",
                                            "brush gap=2mm:5mm",
                                            "vary body.base_cut=0.7:0.8:2",
                                            "rows cases",
                                            "show pictures",
                                            "show map",
                                            "cells design body lift",
                                            "turn design 0.3,0.2,-0.1/0,0,0/0,0,1/0.1",
                                            "outline off",
                                            "workspace compare",
                                            "fields camera=bottom range=-100:100",
                                            "turn compare 0,0,-0.4/0,0,0/0,1,0/0.1",
                                            "workspace tables",
                                            "table lift net_weight=0.25N",
                                            "workspace stability",
                                            "region glide cells=30 start=5mm,1mm/s set.vehicle.net_weight=0.25",
                                            "region glide as_declared=",
                                            "workspace loop",
                                            "unstar case/ellipse-h5-p0",
                                            "reset"};
    for (const auto& line : lines) {
        const std::string before = state_hash(window_->desk().state());
        const auto steps = window_->desk().history().position();
        act(line);
        EXPECT_TRUE(window_->last_error().isEmpty()) << line << window_->last_error().toStdString();
        const std::string after = state_hash(window_->desk().state());
        // Successive actions of the view are one step: undo goes back before all of them.
        const bool own_step = window_->desk().history().position() == steps + 1;
        window_->desk().undo();
        QApplication::processEvents();
        if (own_step) {
            EXPECT_EQ(state_hash(window_->desk().state()), before) << line;
        }
        window_->desk().redo();
        QApplication::processEvents();
        EXPECT_EQ(state_hash(window_->desk().state()), after) << line;
    }
    settle(*window_);
    window_->desk().go_to(1);  // the study stays open
    settle(*window_);
    EXPECT_TRUE(window_->has_study());
    EXPECT_TRUE(window_->desk().state().stars.empty());
    EXPECT_TRUE(window_->desk().state().tables.empty());
}

// A press beside a slider's handle puts it there, and what follows until it is let go is the same gesture: it was a
// step of undo for each tenth of the way.
TEST_F(Window, APressBesideTheHandleIsOneAction) {
    open(computed_study());
    act("workspace tables");
    act("table lift net_weight=0.3N");
    settle(*window_);
    auto* slider = panel<ForcePanel>().findChild<QSlider*>();
    ASSERT_TRUE(slider != nullptr && slider->isEnabled());
    const auto before = window_->desk().history().position();
    const QPoint far(slider->width() * 9 / 10, slider->height() / 2);
    QTest::mousePress(slider, Qt::LeftButton, {}, far);
    EXPECT_GT(slider->value(), 0.8 * slider->maximum());
    QTest::qWait(700);  // longer than a press takes to be repeated
    QMouseEvent move(QEvent::MouseMove, far - QPointF(30, 0), Qt::NoButton, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(slider, &move);
    QTest::mouseRelease(slider, Qt::LeftButton, {}, far - QPoint(30, 0));
    settle(*window_);
    EXPECT_EQ(window_->desk().history().position(), before + 1);
}

TEST_F(Window, ShowsTheBodyOfTheLibraryAndUndoBringsItBack) {
    open(computed_study());
    act("workspace design");
    settle(*window_);
    auto& design = panel<DesignPanel>();
    ASSERT_TRUE(design.shown());
    const auto first = design.shown();
    ASSERT_TRUE(first->certificate && first->certificate->passed());
    ASSERT_TRUE(first->added_mass);
    geometry::BodyOptions bare;
    bare.placement = first->placement;
    const auto said = geometry::read_body(computed_study() / "shapes" / "ellipse.toml", bare);
    EXPECT_EQ(first->added_mass->panels, said.added_mass->panels) << "as `underbody body` has it (608 once: 0.5 % off)";
    act("set 'protrusion.height=2 mm'");
    settle(*window_);
    geometry::BodyOptions options;
    options.set = {{"protrusion.height", "2 mm"}};
    options.panels = 0;
    const auto body = geometry::read_body(computed_study() / "shapes" / "ellipse.toml", options);
    EXPECT_DOUBLE_EQ(design.shown()->mass.volume, body.mass.volume);
    const auto card = [&](const QString& name, int column = 1) {
        for (int row = 0; row < design.card()->rowCount(); ++row) {
            if (design.card()->item(row, 0)->text() == name) {
                return design.card()->item(row, column)->text();
            }
        }
        return QString("no such row");
    };
    EXPECT_EQ(card("volume").toStdString(), core::format_number(1e6 * body.mass.volume, 6) + " cm³");
    EXPECT_FALSE(card("volume", 2).isEmpty()) << "before";
    EXPECT_EQ(design.card()->item(0, 0)->text(), "lift (nearest)") << "seen in the smallest card";
    EXPECT_TRUE(card("lift (nearest)").endsWith("N")) << card("lift (nearest)").toStdString();
    EXPECT_TRUE(card("stable gaps (nearest)").endsWith("mm")) << card("stable gaps (nearest)").toStdString();
    for (int row = 0; row < design.card()->rowCount(); ++row) {
        for (int column = 0; column < 2; ++column) {
            const auto* item = design.card()->item(row, column);
            EXPECT_LE(QFontMetrics(item->font()).horizontalAdvance(item->text()),
                      design.card()->columnWidth(column) - 6)
                << item->text().toStdString() << " is cut";
        }
    }
    const auto with_before = [&] {
        const auto plots = design.findChildren<PlotView*>();
        return std::count_if(plots.begin(), plots.end(), [](const PlotView* plot) {
            const auto& curves = plot->figure().curves;
            return plot->has_figure() && std::any_of(curves.begin(), curves.end(),
                                                     [](const core::FigureCurve& curve) { return curve.width == 0.8; });
        });
    };
    EXPECT_EQ(with_before(), 1) << "its outline in the section";
    QElapsedTimer time;
    time.start();
    window_->desk().undo();
    EXPECT_EQ(design.shown()->mass.volume, first->mass.volume) << "out of the cache, at once";
    EXPECT_LT(time.elapsed(), 1000);
}

// What is drawn as lift says what it rests on; a number changed makes it another shape, whose CFD this is not.
TEST_F(Window, TheLiftOfAShapeSaysWhatItRestsOn) {
    open(computed_study());
    act("workspace design");
    settle(*window_);
    auto& design = panel<DesignPanel>();
    EXPECT_EQ(design.lift().basis, cases::KnownLift::Basis::this_shape);
    const auto said = [&] {
        for (const auto* label : design.findChildren<QLabel*>()) {
            if (label->text().startsWith("Lift: ")) {
                return label->text().toStdString();
            }
        }
        return std::string();
    };
    EXPECT_EQ(said(), "Lift: CFD of this shape (ellipse)");
    act("set body.base_cut=0.7");
    settle(*window_);
    EXPECT_EQ(design.lift().basis, cases::KnownLift::Basis::nearest_shape);
    EXPECT_EQ(said(), "Lift: CFD of ellipse, the nearest shape; not CFD of this one");
}

// The rest of a body is made once, however long it takes (it was begun anew every 120 ms where that was too short).
TEST_F(Window, AddedMassIsMadeOnce) {
    open(computed_study());
    int begun = 0;
    QObject::connect(&window_->jobs(), &Jobs::changed, [&, last = 0]() mutable {
        for (const auto& row : window_->jobs().rows()) {
            if (row.id > last && row.what.startsWith("added mass of")) {
                last = row.id;
                ++begun;
            }
        }
    });
    act("workspace design");
    act("set 'protrusion.height=2 mm'");
    settle(*window_);
    EXPECT_TRUE(panel<DesignPanel>().shown()->added_mass);
    EXPECT_LE(begun, 2) << "of the first shape, perhaps, and of the changed one";
}

TEST_F(Window, AValueThatCannotBeIsRefusedWithTheLibrarysSentence) {
    open(computed_study());
    EXPECT_FALSE(act("set body.base_cut=7"));
    EXPECT_NE(window_->last_error().indexOf("base_cut"), -1);
    EXPECT_TRUE(window_->desk().state().design.changes.empty());
}

TEST_F(Window, ANumberIsShownWithEveryDigit) {
    NumberEdit field("m^2/s", "m^2/s");
    field.show_number(1.5e-6);
    EXPECT_DOUBLE_EQ(field.parsed(field.text()), 1.5e-6);
    EXPECT_NE(field.text().indexOf("1.5e-06"), -1) << field.text().toStdString();
    double entered = 0;
    QObject::connect(&field, &NumberEdit::entered, [&](double value) { entered = value; });
    field.setFocus();
    field.selectAll();
    QTest::keyClicks(&field, "8.7e-6");
    QTest::keyClick(&field, Qt::Key_Return);
    EXPECT_DOUBLE_EQ(entered, 8.7e-6);
    NumberEdit length("m", "mm");
    length.show_number(0.0023);
    EXPECT_EQ(length.text(), "2.3 mm");
    EXPECT_DOUBLE_EQ(length.parsed("0.5 cm"), 0.005);
    EXPECT_DOUBLE_EQ(length.parsed("4"), 0.004);
    EXPECT_THROW(static_cast<void>(length.parsed("4 N")), core::Error);
}

// A number with a comma only turned its frame orange.
TEST_F(Window, ANumberThatIsRefusedSaysWhy) {
    NumberEdit weight("N", "N");
    EXPECT_THROW(static_cast<void>(weight.parsed("0,28 N")), core::InputError);
    open(computed_study());
    act("workspace tables");
    settle(*window_);
    NumberEdit* field = nullptr;
    for (auto* one : panel<ForcePanel>().findChildren<NumberEdit*>()) {
        field = one->accessibleName() == "net weight" ? one : field;
    }
    ASSERT_NE(field, nullptr);
    field->selectAll();
    QTest::keyClicks(field, "0,28 N");
    QTest::keyClick(field, Qt::Key_Return);
    EXPECT_TRUE(field->toolTip().contains("decimal comma")) << field->toolTip().toStdString();
    EXPECT_TRUE(field->toolTip().contains("0.28 N")) << "what is right";
    EXPECT_EQ(window_->statusBar()->currentMessage(), field->toolTip());
    EXPECT_FALSE(window_->desk().state().tables.contains("lift")) << "not taken";
}

TEST_F(Window, TheMotionIsThatOfTheModelThatIsShown) {
    open(computed_study());
    act("workspace stability");
    act("region glide cells=40 start=5mm,0");
    settle(*window_);
    auto& stability = panel<RegionPanel>();
    ASSERT_TRUE(stability.trajectory());
    const auto before = stability.trajectory();
    act("region glide set.vehicle.net_weight=0.05");
    settle(*window_);
    ASSERT_TRUE(stability.trajectory());
    EXPECT_NE(before, stability.trajectory()) << "made again with the map";
}

TEST_F(Window, AReloadReadsWhatChangedOnDisk) {
    const fs::path study = copy_of_study();
    open(study);
    EXPECT_EQ(status_of("ellipse-h5-p0"), status_of("ellipse-h3-p0"));
    const QString was = status_of("ellipse-h5-p0");
    fs::copy_file(study / "fields" / "ellipse-h20-p0.csv", study / "fields" / "ellipse-h5-p0.csv",
                  fs::copy_options::overwrite_existing);
    window_->desk().reload();
    settle(*window_);
    EXPECT_NE(status_of("ellipse-h5-p0"), was);
    EXPECT_EQ(status_of("ellipse-h3-p0"), was);
}

// Also of what is drawn; and before anybody asks, the window says that a file is another one.
TEST_F(Window, AFileThatChangesIsSaidAndShownAnew) {
    const fs::path study = copy_of_study();
    open(study);
    act("select case/ellipse-h5-p0");
    act("workspace compare");
    settle(*window_);
    auto& fields = panel<FieldsPanel>();
    ASSERT_EQ(fields.drawn(), 1U);
    const auto lift = [&] { return fields.numbers()->forces()->item(0, 0)->text(); };
    const QString before = lift();
    auto* banner = window_->findChild<Banner*>();
    EXPECT_FALSE(banner->isVisible());
    fs::copy_file(study / "fields" / "ellipse-h20-p0.csv", study / "fields" / "ellipse-h5-p0.csv",
                  fs::copy_options::overwrite_existing);
    QTRY_VERIFY_WITH_TIMEOUT(banner->isVisible(), 20000);
    EXPECT_TRUE(banner->findChild<QLabel*>("said")->text().contains("has changed on disk"));
    window_->desk().reload();
    settle(*window_);
    EXPECT_NE(lift(), before);
}

TEST_F(Window, AFileFromOutsideIsAmongTheRecentOnes) {
    QStandardPaths::setTestModeEnabled(true);
    QCoreApplication::setOrganizationName("underbody-test");
    QSettings::setPath(QSettings::NativeFormat, QSettings::UserScope, QString::fromStdString(folder_.path().string()));
    const fs::path file = computed_study() / "fields" / "ellipse-h5-p0.csv";
    const auto recent = [&] {
        MainWindow other(true);
        other.ask = [](const QString&, const QString&, const QString&) { return false; };
        QStringList names;
        for (const auto* menu : other.findChildren<QMenu*>()) {
            for (const auto* action : menu->title().contains("ecent") ? menu->actions() : QList<QAction*>()) {
                names << action->text();
            }
        }
        other.take_files({file});
        settle(other);
        return names;
    };
    EXPECT_FALSE(recent().contains(QString::fromStdString(file.string())));
    EXPECT_TRUE(recent().contains(QString::fromStdString(file.string())));
    QCoreApplication::setOrganizationName("");
    QStandardPaths::setTestModeEnabled(false);
}

TEST_F(Window, NotesAreHiddenFromTheProblems) {
    auto& problems = panel<ProblemList>();
    problems.clear();
    problems.note("only told");
    problems.add({core::Problem::Severity::warning, "a warning", {}});
    QAction* only = problems.actions().front();
    only->setChecked(true);
    problems.note("told later");
    QStringList seen;
    for (int i = 0; i < problems.topLevelItemCount(); ++i) {
        seen << (problems.topLevelItem(i)->isHidden() ? QString() : problems.topLevelItem(i)->text(1));
    }
    EXPECT_EQ(seen, (QStringList{"", "a warning", ""}));
    only->setChecked(false);
    EXPECT_FALSE(problems.topLevelItem(0)->isHidden());
}

TEST_F(Window, NothingIsOverwrittenUnasked) {
    const fs::path file = folder_.path() / "t.csv";
    core::write_file(file, "mine");
    const auto write = [](const fs::path& path) { core::write_file(path, "other"); };
    const QString typed = QString::fromStdString((folder_.path() / "t").string());
    EXPECT_FALSE(window_->write_chosen(typed, {".csv"}, write));
    EXPECT_EQ(asked_, 1) << "the ending is added first";
    EXPECT_EQ(core::read_file(file), "mine");
    answer_ = true;
    EXPECT_TRUE(window_->write_chosen(typed, {".csv"}, write));
    EXPECT_EQ(core::read_file(file), "other");
}

TEST_F(Window, ReloadingWhileItComputesDisturbsNothing) {
    const fs::path study = folder_.path() / "fresh";
    test::make_few_gaps(study);
    open(study);
    window_->desk().run_study();
    window_->desk().reload();
    window_->desk().run_study();
    EXPECT_TRUE(window_->desk().computing());
    settle(*window_);
    EXPECT_TRUE(window_->last_error().isEmpty()) << window_->last_error().toStdString();
    EXPECT_EQ(window_->desk().session().results.loads.rows(), 5U);
}

// What another step makes is not missing while the study is computed: it is looked at again at the end.
TEST_F(Window, WhatIsOnItsWayIsNotMissing) {
    open(computed_study());
    const auto look = [&] {
        window_->jobs().start("table", "fitting", [](core::Progress&) -> std::function<void()> {
            throw core::InputError("missing", "the mesh uncertainty '5 mm' was not found");
        });
    };
    std::promise<void> end;
    window_->jobs().start("run", "computing", [done = end.get_future().share()](core::Progress&) {
        done.wait();
        return [] {};
    });
    look();
    while (window_->jobs().busy("table")) {
        QTest::qWait(5);
    }
    EXPECT_EQ(window_->last_error(), "");
    end.set_value();
    settle(*window_);
    look();
    settle(*window_);
    EXPECT_TRUE(window_->last_error().contains("was not found"));
}

TEST_F(Window, WhatACancelledRunHasStoredIsShown) {
    const fs::path study = folder_.path() / "fresh";
    test::make_few_gaps(study);
    open(study);
    window_->desk().run_study();
    // Until the store has a result.
    QElapsedTimer waited;
    waited.start();
    bool any = false;
    while (!any && window_->desk().computing() && waited.elapsed() < 60000) {
        QTest::qWait(20);
        any = cases::stored_loads(window_->desk().session().study, {}).loads.rows() > 0;
    }
    ASSERT_TRUE(any);
    window_->jobs().cancel("run");
    settle(*window_);
    EXPECT_GT(window_->desk().session().results.loads.rows(), 0U);
}

TEST_F(Window, AProblemThatIsFoundAgainStandsThereOnce) {
    auto* list = window_->findChild<ProblemList*>();
    const int before = list->topLevelItemCount();
    const core::Problem problem{core::Problem::Severity::warning, "the turn is not supported", {"a.csv", {}, {}, {}}};
    list->add(problem);
    list->add(problem);
    EXPECT_EQ(list->topLevelItemCount(), before + 1);
    list->add({core::Problem::Severity::warning, "the turn is not supported", {"b.csv", {}, {}, {}}});
    EXPECT_EQ(list->topLevelItemCount(), before + 2) << "in another file it is another one";
    const core::Problem remark{core::Problem::Severity::note, "interpolated: leave-one-out error 0.02 N", {}};
    list->add(remark);
    list->add(remark);
    EXPECT_EQ(list->topLevelItemCount(), before + 3) << "notes about the data, too";
    list->note("Exported lift.h again.");
    list->note("Exported lift.h again.");
    EXPECT_EQ(list->topLevelItemCount(), before + 5) << "what happens twice is told twice";
}

// Tables and Stability rest on the same points: what is said of them is said once, of the table that the study names.
TEST_F(Window, WhatIsSaidOfATableIsSaidOnceAndByItsName) {
    const fs::path study = copy_of_study();
    std::string text = core::read_file(study / "study.toml");
    text.insert(text.find("net_weight"), "relative_sigma = 0.1\n");
    core::write_file(study / "study.toml", text);
    open(study);
    for (const char* workspace : {"tables", "stability"}) {
        act(std::string("workspace ") + workspace);
        settle(*window_);
    }
    const QString said = panel<ProblemList>().text();
    EXPECT_EQ(said.count("the turn at gap"), 1) << said.toStdString();
    EXPECT_EQ(said.count("lift_force-1.csv"), 0) << said.toStdString();
    const QStringList lines = said.split('\n').filter("the turn at gap");
    EXPECT_TRUE(lines.join('\n').endsWith("\ttable 'lift'\t")) << said.toStdString();
}

// A view that fails at each repaint is told once; the same after somebody did something is told again.
TEST_F(Window, ADefectIsToldAgainAfterAnotherAction) {
    struct Failing : QObject {
        bool event(QEvent*) override { throw std::runtime_error("no such view"); }
    } failing;
    std::vector<std::string> told;
    auto& program = application();
    const auto before = std::exchange(
        program.failed, [&](const std::exception_ptr& error) { told.push_back(tell(error).message.toStdString()); });
    const auto repaint = [&] {
        QEvent event(QEvent::User);
        QCoreApplication::sendEvent(&failing, &event);
    };
    QTest::keyClick(window_.get(), Qt::Key_Shift);
    repaint();
    repaint();
    EXPECT_EQ(told.size(), 1U);
    QTest::keyClick(window_.get(), Qt::Key_Shift);
    repaint();
    repaint();
    EXPECT_EQ(told.size(), 2U);
    QTest::mouseClick(window_->findChild<ProblemList*>()->viewport(), Qt::LeftButton);
    repaint();
    ASSERT_EQ(told.size(), 3U);
    EXPECT_EQ(told.back(), "defect of the program: no such view");
    program.failed = before;
}

TEST_F(Window, AnErrorGoesWhenSomethingSucceeds) {
    open(computed_study());
    act("workspace nowhere");
    auto* banner = window_->findChild<Banner*>();
    EXPECT_TRUE(banner->isVisible());
    act("star case/ellipse-h5-p0");
    EXPECT_FALSE(banner->isVisible());
}

TEST_F(Window, TakesWhatIsDroppedByItsContent) {
    open(computed_study());
    const fs::path evie = test::source_folder() / "cases" / "evie";
    window_->take_files({evie / "shapes" / "ellipse_front_bump1.toml"});
    settle(*window_);
    EXPECT_EQ(shown_shape(window_->desk().state(), window_->desk().session()), "ellipse_front_bump1");
    EXPECT_EQ(window_->desk().state().workspace, "design");
    window_->take_files({evie / "fields" / "ellipse-h1-p0.csv", evie / "fields" / "ellipse-h100-p0.csv"});
    settle(*window_);
    EXPECT_EQ(window_->desk().state().workspace, "compare");
    EXPECT_EQ(window_->desk().state().selected("field").size(), 2U) << "all, not the first";
    core::write_file(folder_.path() / "broken.toml", "[body]\nlenght = \"3 mm\"\n");
    window_->take_files({folder_.path() / "broken.toml"});
    EXPECT_NE(window_->last_error().indexOf("lenght"), -1) << window_->last_error().toStdString();
}

double resident_megabytes() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmRSS:")) {
            return std::stod(line.substr(6)) / 1024;
        }
    }
    return 0;
}

// What a job took in small pieces goes back to the machine, not to a heap that is kept for the next ones.
TEST_F(Window, WhatAJobTookIsGivenBack) {
    auto kept = std::make_shared<std::vector<std::unique_ptr<char[]>>>();
    window_->jobs().start("test", "pieces", [kept](core::Progress&) -> std::function<void()> {
        std::vector<std::unique_ptr<char[]>> pieces;
        for (int i = 0; i < 400000; ++i) {
            pieces.push_back(std::make_unique<char[]>(200));
            if (i % 4000 == 3999) {
                kept->push_back(std::move(pieces.back()));
            }
        }
        return {};
    });
    while (window_->jobs().busy()) {
        QTest::qWait(5);
    }
    const double before = resident_megabytes();
    QTest::qWait(1500);
    EXPECT_LT(resident_megabytes(), before - 40);
    EXPECT_EQ(kept->size(), 100U);
}

TEST_F(Window, ATableIsFittedAsTheStudySays) {
    const fs::path study = copy_of_study();
    std::string text = core::read_file(study / "study.toml");
    text.insert(text.find("net_weight"), "fit = \"spline\"\n");
    core::write_file(study / "study.toml", text);
    open(study);
    act("workspace tables");
    settle(*window_);
    ASSERT_TRUE(panel<ForcePanel>().table());
    EXPECT_NE(panel<ForcePanel>().table()->kind().find("spline"), std::string::npos)
        << panel<ForcePanel>().table()->kind();
}

// The errors of the tables' page are those of the report, and follow the net weight.
TEST_F(Window, EquilibriaStandWithTheErrorsOfTheReport) {
    const fs::path folder = copy_of_study();
    std::string text = core::read_file(folder / "study.toml");
    text.insert(text.find("net_weight"), "relative_sigma = 0.01\n");
    core::write_file(folder / "study.toml", text);
    cases::RunOptions options;
    options.pictures = false;
    const auto results = cases::run_study(cases::Study::open(folder), options);
    open(folder);
    act("workspace tables");
    settle(*window_);
    const auto& known = results.tables.front().equilibria;
    ASSERT_FALSE(known.empty());
    const auto* list = panel<ForcePanel>().findChild<QTableWidget*>();
    ASSERT_NE(list, nullptr);
    ASSERT_EQ(list->rowCount(), static_cast<int>(known.size()));
    const auto shown = [](double value) { return QString::fromStdString(core::format_number(value, 2)); };
    for (int row = 0; row < list->rowCount(); ++row) {
        const auto& one = known[static_cast<std::size_t>(row)];
        ASSERT_GT(one.stiffness_sigma, 0);
        EXPECT_EQ(list->item(row, 4)->text(), shown(one.stiffness_sigma));
        EXPECT_EQ(list->item(row, 6)->text(), one.frequency_sigma > 0 ? shown(one.frequency_sigma) : QString("–"));
    }
    const QString before = list->item(0, 4)->text();
    act("table lift net_weight=0.28N");
    settle(*window_);
    ASSERT_GT(list->rowCount(), 0);
    EXPECT_NE(list->item(0, 4)->text(), before);
}

TEST_F(Window, AWeightOutOfReachIsSaid) {
    open(computed_study());
    act("workspace tables");
    act("table lift net_weight=50N");
    settle(*window_);
    bool said = false;
    for (const auto* label : panel<ForcePanel>().findChildren<QLabel*>()) {
        said = said || label->text().contains("No equilibrium");
    }
    EXPECT_TRUE(said);
    // Each table keeps what was said of it, and the slider is long enough to choose a weight with.
    act("table lift net_weight=0.25N");
    EXPECT_EQ(window_->desk().state().tables.at("lift").net_weight, 0.25);
    act("workspace explore");
    act("workspace tables");
    settle(*window_);
    EXPECT_EQ(window_->desk().state().tables.at("lift").net_weight, 0.25);
    int longest = 0;
    for (const auto* slider : panel<ForcePanel>().findChildren<QSlider*>()) {
        longest = std::max(longest, slider->width());
    }
    EXPECT_GE(longest, 100) << "with the wide letters of this platform; 88 px with narrow ones, once";
}

TEST_F(Window, TheBrushKeepsWhatIsWithin) {
    open(computed_study());
    act("workspace explore");
    act("brush gap=2.5mm:10mm");
    settle(*window_);
    EXPECT_EQ(panel<ExplorePanel>().kept().size(), 3U);
    act("brush");
    EXPECT_EQ(panel<ExplorePanel>().kept().size(), 5U);
}

TEST_F(Window, EveryKeyIsOneActionAndEveryInputHasAName) {
    open(computed_study());
    for (const auto& workspace : workspace_names()) {
        act("workspace " + workspace);
        settle(*window_);
    }
    std::map<QString, QString> keys;
    for (const QAction* action : window_->actions()) {
        if (!action->shortcut().isEmpty()) {
            const QString key = action->shortcut().toString();
            EXPECT_TRUE(keys.emplace(key, action->text()).second)
                << key.toStdString() << ": " << action->text().toStdString() << " and " << keys[key].toStdString();
        }
        EXPECT_FALSE(action->text().isEmpty());
    }
    std::map<QChar, QString> letters;
    for (const QAction* menu : window_->menuBar()->actions()) {
        const int at = menu->text().indexOf('&');
        ASSERT_GE(at, 0) << menu->text().toStdString();
        EXPECT_TRUE(letters.emplace(menu->text()[at + 1].toLower(), menu->text()).second) << menu->text().toStdString();
    }
    for (const auto* widget : window_->findChildren<QWidget*>()) {
        const bool input = qobject_cast<const QComboBox*>(widget) != nullptr ||
                           (qobject_cast<const QLineEdit*>(widget) != nullptr &&
                            qobject_cast<const QAbstractSpinBox*>(widget->parentWidget()) == nullptr) ||
                           qobject_cast<const QSlider*>(widget) != nullptr;
        if (input && widget->focusPolicy() != Qt::NoFocus) {
            EXPECT_FALSE(widget->accessibleName().isEmpty())
                << widget->metaObject()->className() << " in " << widget->parentWidget()->objectName().toStdString();
        }
    }
}

TEST_F(Window, ClosingWhileItComputesAsks) {
    const fs::path study = folder_.path() / "fresh";
    test::make_few_gaps(study);
    open(study);
    window_->desk().run_study();
    EXPECT_FALSE(window_->close());
    EXPECT_EQ(asked_, 1);
    answer_ = true;
    EXPECT_TRUE(window_->close());
}

// Figures of a study that is computed are painted and encoded beside the window, which only lays them out; the bytes
// are the same.
TEST_F(Window, FiguresAreEncodedBesideTheWindow) {
    core::Figure figure;
    figure.title = "lift over gap";
    figure.x = {"gap", "mm"};
    figure.y = {"lift force", "N"};
    core::FigureCurve curve{"lift", {}, {}, core::palette(0)};
    for (int i = 0; i < 400; ++i) {
        curve.x.push_back(i);
        curve.y.push_back(std::sin(0.05 * i));
    }
    figure.curves.push_back(curve);
    const std::string here = render_png(figure);
    std::string there;
    double work = 0;
    QEventLoop loop;
    const double before = thread_time();
    std::thread worker([&] {
        there = render_png(figure);
        work = thread_time();
        QMetaObject::invokeMethod(&loop, &QEventLoop::quit, Qt::QueuedConnection);
    });
    loop.exec();
    const double window = thread_time() - before;
    worker.join();
    EXPECT_EQ(there, here);
    EXPECT_LT(window, work);
}

// A seeded monkey: any action at any time, also nonsense and damaged files; then all is taken back.
TEST_F(Window, AMonkeyBreaksNothing) {
    open(computed_study());
    const std::string start = state_hash(window_->desk().state());
    const auto begun = window_->desk().history().position();
    core::write_file(folder_.path() / "damaged.csv", "[Name]\nbase\n[Data]\nX [ m ],Y [ m ]\n1,2,3\n");
    core::write_file(folder_.path() / "damaged.toml", "[body\n");
    const char* seed = std::getenv("UNDERBODY_MONKEY_SEED");
    std::mt19937 random(seed != nullptr ? static_cast<unsigned>(std::atoi(seed)) : 11U);
    const auto share = [&] { return std::uniform_real_distribution<>(0, 1)(random); };
    const std::vector<std::string> cases = {"case/ellipse-h2-p0", "case/ellipse-h3-p0", "case/ellipse-h20-p0"};
    Heartbeat heartbeat;
    // 200 here; UNDERBODY_MONKEY=2000 for longer, any seed by UNDERBODY_MONKEY_SEED.
    const char* asked = std::getenv("UNDERBODY_MONKEY");
    const int actions = asked != nullptr ? std::atoi(asked) : 200;
    for (int step = 0; step < actions; ++step) {
        switch (random() % 12) {
            case 0:
                act("workspace " + workspace_names()[random() % 6]);
                break;
            case 1:
                act("select " + cases[random() % 3] + " " + cases[random() % 3]);
                break;
            case 2:
                act("set body.base_cut=" + std::to_string(0.2 + share()));
                break;
            case 3:
                act("set 'protrusion.height=" + std::to_string(4 * share()) + " mm'");
                break;
            case 4:
                act("table lift net_weight=" + std::to_string(share()) + "N");
                break;
            case 5:
                act("region glide cells=30 start=" + std::to_string(20 * share()) + "mm,1mm/s");
                break;
            case 6:
                act("brush gap=" + std::to_string(0.01 * share()) + ":" + std::to_string(0.01 * share()));
                break;
            case 7:
                window_->desk().undo();
                break;
            case 8:
                window_->desk().redo();
                break;
            case 9:
                window_->jobs().cancel();
                break;
            case 10:
                window_->take_files({folder_.path() / (random() % 2 ? "damaged.csv" : "damaged.toml")});
                break;
            default:
                act("keep v" + std::to_string(random() % 5));
                break;
        }
        QTest::qWait(static_cast<int>(random() % 12));
    }
    settle(*window_);
    // Parsing, laying out and drawing offscreen in a test that is hardly optimised.
    EXPECT_LT(heartbeat.longest(), 0.6);
    window_->desk().go_to(begun);
    settle(*window_);
    EXPECT_EQ(state_hash(window_->desk().state()), start);
}

}  // namespace
}  // namespace underbody::studio
