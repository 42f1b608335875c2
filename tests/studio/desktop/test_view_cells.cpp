// The views of every workspace: from one to six, chosen by hand, undone, and part of the session.
// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
// clang-format on

#include <gtest/gtest.h>

#include <QMenu>
#include <QTabBar>
#include <QToolButton>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/region_panel.h"
#include "studio/desktop/side_by_side.h"
#include "studio/desktop/state/words.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

class ViewCells : public Window {
protected:
    Panel& shown() {
        for (auto* panel : window_->panels()) {
            if (panel->isVisible()) {
                return *panel;
            }
        }
        throw std::logic_error("no workspace is shown");
    }
    /// Names of what is shown.
    std::vector<std::string> seen() {
        std::vector<std::string> names;
        for (const auto& view : shown().views()) {
            if (view.shown) {
                names.push_back(view.name);
            }
        }
        return names;
    }
    QToolButton* hide_button(const QString& title) {
        for (auto* button : shown().findChildren<QToolButton*>()) {
            if (button->accessibleName() == "Hide " + title) {
                return button;
            }
        }
        return nullptr;
    }
};

TEST_F(ViewCells, AreChosenInEveryWorkspace) {
    open(computed_study());
    for (const auto& workspace : workspace_names()) {
        act("workspace " + workspace);
        settle(*window_);
        const auto all = seen();
        ASSERT_GE(all.size(), 2U) << workspace;
        ASSERT_LE(all.size(), 6U) << workspace;
        const std::string before = state_hash(window_->desk().state());
        shown().choose_view(all.back(), false);
        settle(*window_);
        EXPECT_EQ(seen(), std::vector<std::string>(all.begin(), all.end() - 1)) << workspace;
        const nlohmann::json saved = window_->desk().state();
        EXPECT_EQ(state_from_json(saved), window_->desk().state()) << "in the session";
        for (const auto& view : all) {
            shown().choose_view(view, false);
        }
        settle(*window_);
        EXPECT_EQ(seen().size(), 1U) << workspace << ": the last one stays";
        while (state_hash(window_->desk().state()) != before && window_->desk().history().position() > 0) {
            window_->desk().undo();
        }
        settle(*window_);
        EXPECT_EQ(seen(), all) << workspace << ": undone";
        EXPECT_TRUE(window_->last_error().isEmpty()) << window_->last_error().toStdString();
    }
}

// What is hidden leaves its room to the others.
// Every figure was drawn at once, those under other tabs and of other workspaces too.
TEST_F(ViewCells, AFigureIsDrawnWhenItIsSeen) {
    open(computed_study());
    act("workspace design");
    settle(*window_);
    const SideBySide* choice = nullptr;
    for (const auto* widget : shown().findChildren<QWidget*>()) {
        const auto* one = dynamic_cast<const SideBySide*>(widget);
        choice = one != nullptr ? one : choice;
    }
    ASSERT_NE(choice, nullptr);
    ASSERT_TRUE(choice->tabs()->isVisible()) << "there is room for one of them";
    const auto plots = choice->findChildren<PlotView*>();
    ASSERT_EQ(plots.size(), 2);
    act("operation gap=8mm");
    settle(*window_);
    for (const auto* plot : plots) {
        ASSERT_TRUE(plot->has_figure());
        EXPECT_EQ(plot->drawn(), plot->isVisible());
    }
    act("show map");
    settle(*window_);
    for (const auto* plot : plots) {
        EXPECT_TRUE(plot->drawn());
    }
    act("workspace tables");
    settle(*window_);
    window_->resize(window_->width() + 60, window_->height());
    settle(*window_);
    for (const auto* plot : window_->findChildren<PlotView*>()) {
        EXPECT_TRUE(plot->drawn() || !plot->isVisible()) << plot->accessibleName().toStdString();
    }
}

TEST_F(ViewCells, AHiddenOneLeavesItsRoom) {
    window_->resize(1900, 1000);
    open(computed_study());
    act("workspace design");
    settle(*window_);
    auto* hide = hide_button("Section");
    ASSERT_NE(hide, nullptr);
    ASSERT_TRUE(hide->isVisible());
    auto* map = hide_button("Stability map");
    ASSERT_NE(map, nullptr);
    ASSERT_TRUE(map->isVisible());
    const int before = map->parentWidget()->parentWidget()->height();
    hide->click();
    settle(*window_);
    EXPECT_FALSE(hide->isVisible());
    act("cells design map");
    settle(*window_);
    EXPECT_TRUE(map->isVisible());
    EXPECT_GT(map->parentWidget()->parentWidget()->height(), 1.5 * before);
    auto* menu = window_->findChild<QMenu*>("views");
    ASSERT_NE(menu, nullptr);
    Q_EMIT menu->aboutToShow();
    ASSERT_EQ(menu->actions().size(), 4);
    EXPECT_EQ(menu->actions()[0]->text(), "Body");
    EXPECT_FALSE(menu->actions()[0]->isChecked());
    EXPECT_FALSE(menu->actions()[3]->isEnabled()) << "the last one is not hidden";
    menu->actions()[0]->trigger();
    settle(*window_);
    EXPECT_EQ(seen(), (std::vector<std::string>{"body", "map"}));
}

// Other kinds of map stand beside the first, each as the library gives it.
TEST_F(ViewCells, KindsOfMapsStandBesideEachOther) {
    open(computed_study());
    act("workspace stability");
    act("region glide cells=20 draws=4");
    shown().choose_view("probability", true);
    settle(*window_);
    auto& stability = panel<RegionPanel>();
    ASSERT_TRUE(stability.region());
    ASSERT_TRUE(stability.probability()) << window_->last_error().toStdString();
    const auto region = stability.region();
    act("region glide draws=5");
    settle(*window_);
    EXPECT_EQ(stability.probability()->draws, 5U);
    EXPECT_EQ(stability.region(), region) << "what another map does not rest on is not made again";
    shown().choose_view("ends", false);
    settle(*window_);
    EXPECT_FALSE(stability.region());
    EXPECT_EQ(window_->desk().state().regions.at("glide").show, "probability");
}

// Maps and motions with the loop closed; the gains are those of `region --feedback`.
TEST_F(Window, AMapIsMadeUnderFeedback) {
    open(computed_study());
    act("workspace stability");
    act("region glide cells=20 start=5mm,0mm/s");
    settle(*window_);
    auto& stability = panel<RegionPanel>();
    ASSERT_TRUE(stability.trajectory()) << window_->last_error().toStdString();
    const double open_end = stability.trajectory()->gap.back();
    act("region glide feedback=gap_gain=200,velocity_gain=60,reference=12mm");
    settle(*window_);
    ASSERT_TRUE(stability.region()) << window_->last_error().toStdString();
    const double closed_end = stability.trajectory()->gap.back();
    EXPECT_NEAR(closed_end, 0.012, 0.001) << "held";
    EXPECT_GT(std::abs(open_end - closed_end), 0.003);
    bool held = false;
    for (const auto& end : stability.region()->classes) {
        held = held || (std::abs(end.gap - closed_end) < 1e-4 && end.fraction > 0.9);
    }
    EXPECT_TRUE(held) << "every start of the map ends there";
    EXPECT_NE(window_->desk().history().steps().back().command.find("--feedback gap_gain=200"), std::string::npos);
    window_->desk().undo();
    settle(*window_);
    EXPECT_NEAR(stability.trajectory()->gap.back(), open_end, 1e-9);
    EXPECT_FALSE(act("region glide feedback=gap_gian=1"));
}

// A click in a map over gap and pitch shows that motion, too.
TEST_F(Window, AMotionInHeaveAndPitchIsSeen) {
    const fs::path folder = copy_of_study();
    fs::copy_file(test::source_folder() / "cases" / "evie" / "model.toml", folder / "model.toml");
    fs::copy(test::source_folder() / "cases" / "evie" / "tables", folder / "tables");
    core::write_file(folder / "study.toml", core::read_file(folder / "study.toml") +
                                                "\n[[region]]\nname = \"pitched\"\nmodel = \"model.toml\"\n"
                                                "axes = \"gap=2mm:30mm,pitch=-3deg:3deg\"\nfor = \"2 s\"\n"
                                                "columns = 20\nrows = 20\n");
    open(folder);
    act("workspace stability");
    act("select region/pitched");
    act("region pitched cells=20");
    settle(*window_);
    auto& stability = panel<RegionPanel>();
    ASSERT_TRUE(stability.region()) << window_->last_error().toStdString();
    act("region pitched start=gap=8mm,pitch=1deg");
    settle(*window_);
    ASSERT_TRUE(stability.pitch_trajectory()) << window_->last_error().toStdString();
    const auto& motion = *stability.pitch_trajectory();
    EXPECT_DOUBLE_EQ(motion.state.front()[0], 0.008);
    EXPECT_NEAR(motion.state.front()[2], 0.0174533, 1e-6);
    EXPECT_GT(motion.time.back(), 0);
    EXPECT_TRUE(stability.has_table());
}

TEST_F(ViewCells, ViewsOfATableStandBesideEachOther) {
    const fs::path folder = folder_.path() / "pitched";
    test::make_few_gaps(folder);
    for (const char* name : {"ellipse-h3-p2.csv", "ellipse-h5-p2.csv", "ellipse-h10-p2.csv", "ellipse-h3-p-2.csv",
                             "ellipse-h5-p-2.csv", "ellipse-h10-p-2.csv"}) {
        fs::copy_file(test::source_folder() / "cases" / "evie" / "fields" / name, folder / "fields" / name);
    }
    core::write_file(folder / "study.toml",
                     core::read_file(folder / "study.toml") +
                         "\n[[table]]\nname = \"pitched\"\nquantity = \"lift_force\"\naxes = [\"gap\", \"pitch\"]\n"
                         "where = { variant = \"ellipse\", speed = \"0.5 m/s\" }\n");
    const auto run = test::run_underbody({"study", "run", folder.string(), "--no-pictures"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    open(folder);
    act("workspace tables");
    act("select table/pitched");
    settle(*window_);
    auto& tables = panel<ForcePanel>();
    ASSERT_TRUE(tables.table()) << window_->last_error().toStdString();
    shown().choose_view("map gap pitch", true);
    shown().choose_view("curve pitch", true);
    settle(*window_);
    ASSERT_EQ(tables.beside().size(), 2U);
    for (const auto* one : tables.beside()) {
        EXPECT_TRUE(one->isVisible());
        EXPECT_TRUE(one->has_figure()) << one->sentence().toStdString();
    }
    EXPECT_EQ(tables.beside()[1]->figure().x.label, "pitch");
    window_->desk().undo();
    settle(*window_);
    EXPECT_FALSE(tables.beside()[1]->isVisible());
    act("select table/lift");
    settle(*window_);
    EXPECT_FALSE(tables.beside()[0]->isVisible()) << "each table its own";
}

}  // namespace
}  // namespace underbody::studio
