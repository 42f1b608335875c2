// What sitting down before the window showed to be wrong: each walk of a new user that went wrong once.
#include <gtest/gtest.h>
#include <qcustomplot.h>

#include <QApplication>
#include <QComboBox>
#include <QDockWidget>
#include <QLabel>
#include <QScrollArea>
#include <QScrollBar>
#include <QTableView>
#include <QTest>
#include <QToolButton>
#include <QWheelEvent>

#include "cases/add_table.h"
#include "core/table.h"
#include "studio/desktop/case_points.h"
#include "studio/desktop/compare_numbers.h"
#include "studio/desktop/design_panel.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/problems_panel.h"
#include "tests/studio/desktop/heartbeat.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

class Journey : public Window {
protected:
    /// Not computed.
    fs::path fresh_study() {
        test::make_few_gaps(folder_.path() / "fresh");
        return folder_.path() / "fresh";
    }
    static void cut(const fs::path& file) {
        const std::string text = core::read_file(file);
        core::write_file(file, text.substr(0, text.size() / 3));
    }
    static void replace(const fs::path& file, const std::string& what, const std::string& by) {
        std::string text = core::read_file(file);
        const auto at = text.find(what);
        ASSERT_NE(at, std::string::npos) << what;
        core::write_file(file, text.replace(at, what.size(), by));
    }
    void run(const fs::path& study) {
        window_->desk().open_and_run(study);
        settle(*window_);
    }
};

TEST_F(Journey, ACaseThatFailedSaysSoAndWhy) {
    const fs::path study = fresh_study();
    cut(study / "fields" / "ellipse-h10-p0.csv");
    run(study);
    EXPECT_EQ(status_of("ellipse-h10-p0"), "failed");
    EXPECT_EQ(status_of("ellipse-h5-p0"), "done");
    EXPECT_TRUE(panel<ProblemList>().text().contains("ellipse-h10-p0.csv"))
        << panel<ProblemList>().text().toStdString();
    EXPECT_TRUE(panel<ProblemList>().text().contains("the file")) << "the reader's sentence";
    const auto before = window_->desk().session_pointer();
    act("workspace tables");
    settle(*window_);
    EXPECT_EQ(window_->desk().session_pointer(), before) << "an action is no reason to read the study again";
    fs::copy_file(computed_study() / "fields" / "ellipse-h10-p0.csv", study / "fields" / "ellipse-h10-p0.csv",
                  fs::copy_options::overwrite_existing);
    window_->desk().reload();
    settle(*window_);
    EXPECT_EQ(status_of("ellipse-h10-p0"), "not run") << "what failed was another file";
    window_->desk().run_study();
    settle(*window_);
    EXPECT_EQ(status_of("ellipse-h10-p0"), "done");
}

TEST_F(Journey, WhatMakesNumbersLessStandsAmongTheProblems) {
    const fs::path study = fresh_study();
    replace(study / "study.toml", "symmetry = \"y\"\n", "");
    run(study);
    EXPECT_EQ(status_of("ellipse-h5-p0"), "warning");
    EXPECT_EQ(panel<ProblemList>().text().count("the surface is not closed"), 1) << "once for all that have it";
}

TEST_F(Journey, AStudyWithoutShapesBeginsWithItsCases) {
    const fs::path study = fresh_study();
    replace(study / "study.toml", "[[body]]\nname = \"ellipse\"\nshape = \"shapes/ellipse.toml\"\n", "");
    open(study);
    EXPECT_EQ(window_->desk().state().workspace, "compare");
    open(computed_study());
    EXPECT_EQ(window_->desk().state().workspace, "compare") << "where somebody is, he stays";
}

// The [[table]] that it says makes that table.
TEST_F(Journey, CasesWithoutATableAreDrawnAndTheTableIsSaid) {
    const fs::path study = fresh_study();
    const std::string text = core::read_file(study / "study.toml");
    core::write_file(study / "study.toml", text.substr(0, text.find("[[table]]")));
    run(study);
    act("workspace tables");
    settle(*window_);
    EXPECT_TRUE(panel<ForcePanel>().has_picture());
    const auto& loads = window_->desk().session().results.loads;
    const auto& session = window_->desk().session();
    const auto figure = lift_of_cases(session.study, session.results);
    ASSERT_EQ(figure.points.size(), 1U);
    ASSERT_EQ(figure.points[0].x.size(), 5U);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_DOUBLE_EQ(figure.points[0].x[i], 1000 * loads.numbers("gap")[i]);
        EXPECT_DOUBLE_EQ(figure.points[0].y[i], loads.numbers("lift_force")[i]);
    }
    const cases::NewTable table = cases::proposed_table(session.study);
    core::write_file(study / "study.toml", core::read_file(study / "study.toml") + "\n" +
                                               cases::lines_of(table, cases::plan_table(session.study, table)));
    window_->desk().reload();
    settle(*window_);
    ASSERT_TRUE(panel<ForcePanel>().table()) << window_->last_error().toStdString();
    EXPECT_EQ(panel<ForcePanel>().table_name(), "lift");
}

// Every condition that tells cases at equal gaps apart is in it, as a number that selects them.
TEST_F(Journey, OfSeveralConditionsTheTableTakesTheFullest) {
    cases::Study study;
    cases::StudyResults results;
    const auto add = [&](double gap, std::optional<double> pitch, const std::string& variant, double lift) {
        cases::Case one;
        one.conditions.set("gap", gap);
        one.conditions.set("speed", 0.5);
        if (pitch) {
            one.conditions.set("pitch", *pitch);
        }
        one.conditions.texts = {{"variant", variant}};
        results.case_loads.emplace_back();
        results.case_loads.back().entry = study.cases.size();
        results.case_loads.back().values = {{"lift_force", "N", lift}};
        study.cases.push_back(one);
    };
    EXPECT_EQ(cases::text_of(cases::proposed_table(study).where), "");
    EXPECT_TRUE(lift_of_cases(study, results).points.empty());
    for (const double pitch : {0.0, 0.1, core::convert(12.345, "deg", "rad"), core::convert(2, "deg", "rad")}) {
        study = {};
        results = {};
        for (const double gap : {0.002, 0.005, 0.01}) {
            add(gap, pitch, "plain", 0.4);
        }
        add(0.005, pitch + 0.02, "plain", 0.7);
        add(0.005, pitch, "wide", 0.9);
        for (const double gap : {0.001, 0.002, 0.003, 0.004}) {
            add(gap, {}, "unknown pitch", 0.2);
        }
        const auto figure = lift_of_cases(study, results);
        ASSERT_EQ(figure.points.size(), 4U);
        EXPECT_EQ(figure.points[0].x.size(), 3U);
        const std::string text = cases::text_of(cases::proposed_table(study).where);
        EXPECT_EQ(text.find("speed"), std::string::npos) << "the same in all: " << text;
        const auto wanted = cases::conditions_from(text);
        for (std::size_t i = 0; i < study.cases.size(); ++i) {
            EXPECT_EQ(study.cases[i].conditions.satisfies(wanted), i < 3) << text << " of case " << i;
        }
    }
    const cases::NewTable table = cases::proposed_table(study);
    EXPECT_NE(cases::lines_of(table, cases::plan_table(study, table)).find("pitch = \"2 deg\""), std::string::npos);
}

TEST_F(Journey, AnEmptyStudyIsNoTrap) {
    core::write_file(folder_.path() / "empty" / "study.toml", "title = \"nothing yet\"\n");
    open(folder_.path() / "empty");
    for (const auto& workspace : workspace_names()) {
        act("workspace " + workspace);
        settle(*window_);
        EXPECT_TRUE(window_->last_error().isEmpty()) << workspace << window_->last_error().toStdString();
    }
}

// The wheel over a list of parameters rolls it; a value under the mouse was changed in passing.
TEST_F(Journey, TheWheelChangesNoValueInPassing) {
    open(computed_study());
    act("workspace design");
    settle(*window_);
    const std::string before = state_hash(window_->desk().state());
    const auto turn = [](QWidget* over) {
        const QPointF at(over->width() / 2.0, over->height() / 2.0);
        QWheelEvent event(at, over->mapToGlobal(at.toPoint()), {}, {0, -120}, Qt::NoButton, Qt::NoModifier,
                          Qt::NoScrollPhase, false);
        QApplication::sendEvent(over, &event);
        settle(*qobject_cast<MainWindow*>(over->window()));
    };
    auto& design = panel<DesignPanel>();
    QComboBox* base = nullptr;
    for (auto* box : design.findChildren<QComboBox*>()) {
        base = box->accessibleName() == "body.base" ? box : base;
    }
    ASSERT_NE(base, nullptr);
    turn(base);
    auto* slider = design.findChildren<QSlider*>().at(1);
    turn(slider);
    EXPECT_EQ(state_hash(window_->desk().state()), before);
    EXPECT_NE(base->focusPolicy(), Qt::WheelFocus) << "the wheel takes no keyboard either";
    slider->setFocus();
    turn(slider);
    EXPECT_NE(state_hash(window_->desk().state()), before) << "with the keyboard it is meant";
}

// The section grew away each time that its place was narrower for a moment.
TEST_F(Journey, TheSectionKeepsItsScale) {
    open(computed_study());
    act("workspace design");
    settle(*window_);
    const auto ranges = [&] {
        std::vector<double> all;
        for (auto* plot : panel<DesignPanel>().findChildren<QCustomPlot*>()) {
            plot->replot();
            all.push_back(plot->xAxis->range().size());
            all.push_back(plot->yAxis->range().size());
        }
        return all;
    };
    const auto before = ranges();
    ASSERT_GE(before.size(), 4U);
    const QSize size = window_->size();
    for (const QSize other : {QSize(900, 900), QSize(1800, 600), size}) {
        window_->resize(other);
        settle(*window_);
        static_cast<void>(ranges());
    }
    act("workspace explore");
    settle(*window_);
    act("workspace design");
    settle(*window_);
    const auto after = ranges();
    for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_NEAR(after[i], before[i], 0.02 * before[i]) << i;
    }
}

// On the screen of a common laptop nothing is cut: no workspace is rolled to be seen.
TEST_F(Journey, EveryWorkspaceFitsALaptop) {
    window_->resize(1440, 900);
    open(computed_study());
    act("select case/ellipse-h5-p0 case/ellipse-h2-p0");
    for (const auto& workspace : workspace_names()) {
        act("workspace " + workspace);
        settle(*window_);
        for (auto* area : window_->centralWidget()->findChildren<QScrollArea*>(QString(), Qt::FindDirectChildrenOnly)) {
            EXPECT_EQ(area->verticalScrollBar()->maximum(), 0) << workspace;
            EXPECT_EQ(area->horizontalScrollBar()->maximum(), 0) << workspace;
        }
    }
}

// A new window fits the screen; where it is narrower than before the tree gives way, not the numbers.
TEST_F(Journey, ASmallerScreenShowsTheNumbersWhole) {
    for (const QSize screen : {QSize(1280, 800), QSize(1366, 728), QSize(1024, 600)}) {
        const QSize first = MainWindow::first_size(screen);
        EXPECT_LT(first.width(), screen.width());
        EXPECT_LT(first.height(), screen.height() - 30) << "the window's title has room, too";
    }
    EXPECT_EQ(MainWindow::first_size({1920, 1080}), QSize(1440, 900));
    window_->resize(1440, 900);
    open(computed_study());
    act("workspace design");
    settle(*window_);
    auto* tree = window_->findChild<QDockWidget*>("study_dock");
    window_->resizeDocks({tree}, {490}, Qt::Horizontal);
    settle(*window_);
    window_->resize(MainWindow::first_size({1280, 800}));
    settle(*window_);
    for (auto* area : window_->centralWidget()->findChildren<QScrollArea*>(QString(), Qt::FindDirectChildrenOnly)) {
        EXPECT_EQ(area->horizontalScrollBar()->maximum(), 0);
    }
    int seen = 0;
    for (const auto* number : panel<DesignPanel>().findChildren<NumberEdit*>()) {
        if (const QRect part = number->visibleRegion().boundingRect(); !part.isEmpty()) {
            EXPECT_EQ(part.width(), number->width()) << number->accessibleName().toStdString();
            ++seen;
        }
    }
    EXPECT_GE(seen, 3);
    EXPECT_GE(tree->width(), 200);
}

TEST_F(Journey, CurvesUnderAComparisonHaveRoom) {
    window_->resize(1440, 900);
    open(computed_study());
    act("select case/ellipse-h5-p0 case/ellipse-h2-p0");
    act("workspace compare");
    settle(*window_);
    auto& numbers = panel<CompareNumbers>();
    const int rows = numbers.height();
    numbers.setCurrentIndex(3);
    settle(*window_);
    EXPECT_GE(numbers.findChildren<PlotView*>().last()->height(), 180);
    numbers.setCurrentIndex(0);
    settle(*window_);
    EXPECT_NEAR(numbers.height(), rows, 12) << "the pictures have their room again";
}

TEST_F(Journey, KeptCasesStandInTheirNaturalOrder) {
    open(computed_study());
    act("workspace explore");
    settle(*window_);
    QStringList names;
    for (auto* table : panel<ExplorePanel>().findChildren<QTableView*>()) {
        for (int row = 0; table->accessibleName() == "What is kept" && row < table->model()->rowCount(); ++row) {
            names << table->model()->index(row, 0).data().toString();
        }
    }
    EXPECT_EQ(names.join(' '), "ellipse-h2-p0 ellipse-h3-p0 ellipse-h5-p0 ellipse-h10-p0 ellipse-h20-p0");
    for (auto* box : panel<ExplorePanel>().findChildren<QComboBox*>()) {
        EXPECT_FALSE(box->accessibleName().endsWith("scatter plot") && box->currentText().contains('_'))
            << box->currentText().toStdString();
    }
}

// A gap of 1 to 100 mm: half way up the axis are 10, not 50.
TEST_F(Journey, AnAxisOverDecadesIsLogarithmic) {
    ParallelView view(nullptr);
    view.resize(600, 300);
    ParallelView::Axis gap{"gap", "gap (mm)", 1000, {0.001, 0.002, 0.005, 0.1}, 0, 1};
    ParallelView::Axis pitch{"pitch", "pitch", 1, {-1, 0, 1, 2}, 0, 1};
    view.show_axes({gap, pitch});
    double low = 0, high = 0;
    QObject::connect(&view, &ParallelView::brushed, [&](const QString&, double a, double b) {
        low = a;
        high = b;
    });
    constexpr int x = 60, bottom = 22;
    const int middle = (view.head() + 300 - bottom) / 2;
    QTest::mousePress(&view, Qt::LeftButton, {}, {x, 300 - bottom});
    QMouseEvent move(QEvent::MouseMove, QPointF(x, middle), Qt::NoButton, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(&view, &move);
    QTest::mouseRelease(&view, Qt::LeftButton, {}, {x, middle});
    EXPECT_NEAR(low, 0.001, 1e-5);
    EXPECT_NEAR(high, 0.01, 0.0005);
}

// Fault 11 of the first window: a study was computed with 32 stalls of more than 50 ms, the longest of 567 ms.
TEST_F(Journey, ComputingDoesNotStopTheWindow) {
    const fs::path study = fresh_study();
    open(study);
    for (const auto& workspace : workspace_names()) {  // what is made once at first sight is not of the computing
        act("workspace " + workspace);
        settle(*window_);
    }
    act("workspace tables");
    settle(*window_);
    Heartbeat heartbeat;
    window_->desk().run_study();
    settle(*window_);
    std::printf("longest gap while a study is computed: %.0f ms of processor time\n", 1000 * heartbeat.longest());
    EXPECT_LT(heartbeat.longest(), 0.1);
    EXPECT_EQ(status_of("ellipse-h5-p0"), "done");
}

// Of rows chosen one after the other the last one alone was left, and Enter did nothing.
TEST_F(Journey, SeveralRowsOfTheTableAreChosenAndCompared) {
    open(computed_study());
    act("workspace explore");
    settle(*window_);
    auto* table = panel<ExplorePanel>().findChild<QTableView*>();
    ASSERT_EQ(table->model()->rowCount(), 5);
    using Selection = QItemSelectionModel;
    for (const int row : {0, 2, 3}) {
        table->selectionModel()->select(table->model()->index(row, 0), Selection::Select | Selection::Rows);
    }
    EXPECT_EQ(window_->desk().state().selected("case").size(), 3U);
    EXPECT_EQ(table->selectionModel()->selectedRows().size(), 3) << "they are seen to be chosen";
    act("select case/ellipse-h5-p0");
    EXPECT_EQ(table->selectionModel()->selectedRows().size(), 1) << "what is chosen elsewhere is chosen here";
    act("select case/ellipse-h5-p0 case/ellipse-h2-p0");
    table->setCurrentIndex(table->selectionModel()->selectedRows().front());
    act("select case/ellipse-h5-p0 case/ellipse-h2-p0");
    QTest::keyClick(table, Qt::Key_Return);
    EXPECT_EQ(window_->desk().state().workspace, "compare");
    EXPECT_EQ(window_->desk().state().selected("case").size(), 2U);
}

TEST_F(Journey, ARangeMayBeOneValue) {
    open(computed_study());
    act("workspace explore");
    settle(*window_);
    for (const char* line : {"brush gap=5mm", "brush gap=5mm:5mm", "brush gap=0.5cm"}) {
        act("brush");
        ASSERT_TRUE(act(line)) << line;
        EXPECT_EQ(panel<ExplorePanel>().kept().size(), 1U) << line;
    }
    EXPECT_TRUE(act("brush gap="));
    EXPECT_EQ(panel<ExplorePanel>().kept().size(), 5U);
}

TEST_F(Journey, CompareSaysWhatOfTheChosenItShows) {
    open(computed_study());
    act("workspace compare");
    settle(*window_);
    auto& fields = panel<FieldsPanel>();
    EXPECT_TRUE(fields.said_of_choice().startsWith("No case is chosen")) << fields.said_of_choice().toStdString();
    act("select case/ellipse-h5-p0");
    EXPECT_EQ(fields.said_of_choice(), "");
    std::string more = "select";
    for (const auto& one : window_->desk().session().study.cases) {
        more += " case/" + one.name;
    }
    act(more);  // as many as there are: five
    EXPECT_EQ(fields.said_of_choice(), "");
    for (const char* name : {"a.csv", "b.csv"}) {
        fs::copy_file(computed_study() / "fields" / "ellipse-h5-p0.csv", folder_.path() / name);
        act("add field " + (folder_.path() / name).string());
        more += " field/" + (folder_.path() / name).string();
    }
    act(more);
    EXPECT_TRUE(fields.said_of_choice().startsWith("6 of 7 chosen")) << fields.said_of_choice().toStdString();
    settle(*window_);
}

// After Enter the field kept the keyboard, and its own empty history the key.
TEST_F(Journey, UndoWorksFromAFieldInWhichNothingIsTyped) {
    open(computed_study());
    act("workspace design");
    settle(*window_);
    auto* number = panel<DesignPanel>().findChild<ParameterRow*>("body.length")->number();
    number->selectAll();
    QTest::keyClicks(number, "200 mm");
    QKeyEvent undo(QEvent::ShortcutOverride, Qt::Key_Z, Qt::ControlModifier);
    QApplication::sendEvent(number, &undo);
    EXPECT_TRUE(undo.isAccepted()) << "what is typed is its own";
    QTest::keyClick(number, Qt::Key_Return);
    EXPECT_EQ(window_->desk().state().design.changes.at("ellipse").at("body.length"), "200 mm");
    QKeyEvent after(QEvent::ShortcutOverride, Qt::Key_Z, Qt::ControlModifier);
    QApplication::sendEvent(number, &after);
    EXPECT_FALSE(after.isAccepted());
}

TEST_F(Journey, NumbersOfPartsThatTheShapeHasNotAreFolded) {
    open(computed_study());
    act("workspace design");
    settle(*window_);
    auto& design = panel<DesignPanel>();
    auto* height = design.findChild<ParameterRow*>("protrusion.height");
    EXPECT_FALSE(height->isVisible());
    EXPECT_TRUE(design.findChild<ParameterRow*>("body.length")->isVisible());
    for (const auto& parameter : geometry::parameter_names()) {
        EXPECT_TRUE(parameter.unit.empty() ||
                    design.findChild<ParameterRow*>(QString::fromStdString(parameter.name)) != nullptr)
            << parameter.name << " can be reached";
    }
    auto* fold = design.findChild<QToolButton*>("fold protrusion");
    QTest::mouseClick(fold, Qt::LeftButton);
    EXPECT_TRUE(height->isVisible());
    settle(*window_);
    EXPECT_TRUE(height->slider()->isEnabled()) << "with its limits";
    QTest::mouseClick(fold, Qt::LeftButton);
    EXPECT_FALSE(height->isVisible());
    act("set 'nozzle.diameter=5 mm'");
    EXPECT_TRUE(design.findChild<ParameterRow*>("nozzle.diameter")->isVisible()) << "a part that is there is seen";
}

// Views, brush and stars were gone when the window was closed.
TEST_F(Journey, AStudyIsOpenedAsItWasLeft) {
    const fs::path study = copy_of_study();
    const auto opened = [&](const std::function<void(Desk&)>& then) {
        Jobs jobs(nullptr);
        Desk desk(jobs, folder_.path() / "logs", nullptr);
        desk.open_study(study);
        for (int i = 0; i < 3000 && (!desk.has_study() || jobs.busy("open")); ++i) {
            QTest::qWait(10);
        }
        then(desk);
        desk.keep_session();
    };
    opened([](Desk& desk) {
        EXPECT_EQ(desk.state().workspace, "design");
        for (const char* line : {"workspace explore", "brush gap=2mm:5mm", "star case/ellipse-h5-p0",
                                 "fields camera=bottom", "set 'body.length=200 mm'", "cells design body section"}) {
            EXPECT_TRUE(desk.act(words_of(line))) << line;
        }
    });
    opened([](Desk& desk) {
        const State& state = desk.state();
        EXPECT_EQ(state.workspace, "explore");
        EXPECT_EQ(state.explore.brush.count("gap"), 1U);
        EXPECT_TRUE(state.stars.contains("case/ellipse-h5-p0"));
        EXPECT_EQ(state.fields.camera, "bottom");
        EXPECT_EQ(state.design.changes.at("ellipse").at("body.length"), "200 mm");
        EXPECT_EQ(state.cells.at("design").size(), 2U);
        EXPECT_EQ(desk.history().steps().back().name, "open a study as it was left");
        desk.undo();
        EXPECT_TRUE(desk.state().study.empty()) << "opening is one step";
        desk.redo();
    });
    core::write_file(study / ".underbody" / "session.ubs", "{}");
    opened([&](Desk& desk) { EXPECT_EQ(desk.state().study, study.string()) << "a damaged one is passed over"; });
}

}  // namespace
}  // namespace underbody::studio
