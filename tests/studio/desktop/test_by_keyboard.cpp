// The main actions of the journeys by keyboard alone.
#include <gtest/gtest.h>

#include <QAbstractButton>
#include <QApplication>
#include <QComboBox>
#include <QLineEdit>
#include <QListWidget>
#include <QProgressBar>
#include <QPushButton>
#include <QTableView>
#include <QTableWidget>
#include <QTest>
#include <algorithm>
#include <chrono>
#include <thread>

#include "studio/desktop/design_panel.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/export_dialog.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/take_in_sheet.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

class ByKeyboard : public Window {
protected:
    /// A key for whatever has the keyboard.
    void key(int code, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        QWidget* there = QApplication::focusWidget();
        QTest::keyClick(there != nullptr ? there : window_.get(), static_cast<Qt::Key>(code), modifiers);
    }
    void type(const QString& text) { QTest::keyClicks(QApplication::focusWidget(), text); }
    /// Tab until the keyboard is there.
    bool tab_to(const QWidget* wanted) {
        for (int i = 0; i < 400 && QApplication::focusWidget() != wanted; ++i) {
            key(Qt::Key_Tab);
        }
        return QApplication::focusWidget() == wanted;
    }
    void begin(const fs::path& study) {
        open(study);
        QApplication::setActiveWindow(window_.get());
        window_->setFocus();
    }
    const State& state() { return window_->desk().state(); }
};

// Journey 1: what files are is said and taken in.
TEST_F(ByKeyboard, FilesAreTakenIn) {
    begin(copy_of_study());
    const fs::path run = folder_.path() / "run7";
    fs::create_directories(run);
    for (const char* gap : {"2", "3"}) {
        fs::copy_file(
            test::source_folder() / "cases" / "evie" / "fields" / ("ellipse-h" + std::string(gap) + "-p0.csv"),
            run / ("run7_h" + std::string(gap) + "mm_p0.csv"));
    }
    auto* sheet = window_->take_in({run});
    settle(*window_);
    ASSERT_NE(sheet, nullptr);
    QApplication::setActiveWindow(sheet);
    ASSERT_TRUE(tab_to(sheet->pattern()));
    EXPECT_TRUE(sheet->pattern()->text().contains("{gap:mm}")) << sheet->pattern()->text().toStdString();
    ASSERT_TRUE(tab_to(sheet->conditions()));
    key(Qt::Key_A, Qt::ControlModifier);
    type("speed=0.5m/s, variant=run7");  // longer than a short text: it was read after it was gone
    ASSERT_TRUE(tab_to(sheet->half()));
    for (int i = 0; i < 4 && sheet->half()->currentData().toString() != "y"; ++i) {
        key(Qt::Key_Down);
    }
    settle(*window_);
    EXPECT_EQ(sheet->wrong(), "");
    QPushButton* take = nullptr;
    for (auto* button : sheet->findChildren<QPushButton*>()) {
        take = button->text().contains("Take in") ? button : take;
    }
    ASSERT_TRUE(take != nullptr && tab_to(take));
    key(Qt::Key_Space);
    settle(*window_);
    EXPECT_EQ(window_->desk().session().folder, run) << window_->last_error().toStdString();
    const auto& cases = window_->desk().session().study.cases;
    ASSERT_EQ(cases.size(), 2U);
    EXPECT_EQ(cases.front().conditions.text("variant").value_or(""), "run7");
}

// Journey 2: a number of a shape, pinned, taken back, kept.
TEST_F(ByKeyboard, AShapeIsChanged) {
    begin(computed_study());
    key(Qt::Key_F2);
    settle(*window_);
    ASSERT_EQ(state().workspace, "design");
    auto& design = panel<DesignPanel>();
    key(Qt::Key_D, Qt::ControlModifier);
    EXPECT_EQ(state().design.before_shape, "ellipse");
    auto* row = design.findChild<ParameterRow*>("body.length");
    ASSERT_TRUE(tab_to(row->number()));
    key(Qt::Key_A, Qt::ControlModifier);
    type("198 mm");
    key(Qt::Key_Return);
    settle(*window_);
    EXPECT_EQ(state().design.changes.at("ellipse").at("body.length"), "198 mm");
    ASSERT_TRUE(tab_to(row->slider()));
    key(Qt::Key_Right);
    settle(*window_);
    EXPECT_NE(state().design.changes.at("ellipse").at("body.length"), "198 mm");
    key(Qt::Key_Z, Qt::ControlModifier);
    key(Qt::Key_Z, Qt::ControlModifier);
    settle(*window_);
    EXPECT_TRUE(state().design.changes.empty());
    key(Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
    EXPECT_EQ(state().design.changes.at("ellipse").at("body.length"), "198 mm");
    settle(*window_);
}

// The palette finds a number of a shape, of a part that is folded away too.
TEST_F(ByKeyboard, ANumberIsFoundByItsName) {
    begin(computed_study());
    key(Qt::Key_F6);
    settle(*window_);
    key(Qt::Key_K, Qt::ControlModifier);
    auto* palette = window_->findChild<QDialog*>("palette");
    ASSERT_NE(palette, nullptr);
    QApplication::setActiveWindow(palette);
    palette->findChild<QLineEdit*>()->setFocus();
    type("protrusion height");
    key(Qt::Key_Return);
    QApplication::setActiveWindow(window_.get());
    settle(*window_);
    EXPECT_EQ(state().workspace, "design");
    auto* row = panel<DesignPanel>().findChild<ParameterRow*>("protrusion.height");
    EXPECT_TRUE(row->isVisible());
    EXPECT_EQ(window_->focusWidget(), row->number());
    EXPECT_FALSE(row->number()->visibleRegion().isEmpty()) << "rolled to where it is seen";
}

// A verb that is taken stands in the line, to be written on; what it takes and an example stay beside it.
TEST_F(ByKeyboard, AnActionIsWrittenInThePalette) {
    begin(computed_study());
    key(Qt::Key_F3);
    settle(*window_);
    key(Qt::Key_K, Qt::ControlModifier);
    auto* palette = window_->findChild<QDialog*>("palette");
    ASSERT_NE(palette, nullptr);
    QApplication::setActiveWindow(palette);
    auto* line = palette->findChild<QLineEdit*>();
    auto* list = palette->findChild<QListWidget*>();
    line->setFocus();
    type("brush");
    int row = 0;
    while (row < list->count() && !list->item(row)->text().startsWith("brush COLUMN")) {
        ++row;
    }
    ASSERT_LT(row, list->count());
    list->setCurrentRow(row);
    list->setFocus();
    Q_EMIT list->itemActivated(list->item(row));  // a double click
    EXPECT_EQ(line->text(), "brush ");
    EXPECT_TRUE(line->hasFocus());
    ASSERT_GE(list->count(), 2);
    EXPECT_TRUE(list->item(0)->text().startsWith("brush COLUMN=LOW:HIGH")) << list->item(0)->text().toStdString();
    EXPECT_TRUE(list->item(1)->text().startsWith("brush gap=2mm:5mm")) << list->item(1)->text().toStdString();
    type("gap=2mm:4mm");
    ASSERT_GE(list->count(), 2) << "what it takes is still told";
    key(Qt::Key_Return);
    QApplication::setActiveWindow(window_.get());
    settle(*window_);
    EXPECT_EQ(state().explore.brush.count("gap"), 1U);
}

// Journeys 3 and 4: ranges, order of the axes, a star, and what is chosen side by side.
TEST_F(ByKeyboard, CasesAreNarrowedAndCompared) {
    begin(computed_study());
    key(Qt::Key_F3);
    settle(*window_);
    auto& explore = panel<ExplorePanel>();
    ASSERT_TRUE(tab_to(explore.findChild<ParallelView*>()));
    key(Qt::Key_Down);
    key(Qt::Key_Right, Qt::ControlModifier);
    EXPECT_EQ(explore.kept().size(), 4U);
    EXPECT_FALSE(state().explore.order.empty());
    auto* table = explore.findChild<QTableView*>();
    ASSERT_TRUE(tab_to(table));
    key(Qt::Key_Home, Qt::ControlModifier);
    key(Qt::Key_Down, Qt::ShiftModifier);
    ASSERT_EQ(state().selected("case").size(), 2U);
    key(Qt::Key_B, Qt::ControlModifier);
    EXPECT_EQ(state().stars.size(), 2U);
    key(Qt::Key_Return);
    settle(*window_);
    EXPECT_EQ(state().workspace, "compare");
    EXPECT_EQ(panel<FieldsPanel>().drawn(), 2U);
}

// Journey 5: from a table to a proof.
TEST_F(ByKeyboard, ATableIsProved) {
    begin(computed_study());
    key(Qt::Key_F6);
    settle(*window_);
    ASSERT_EQ(state().workspace, "tables");
    key(Qt::Key_E, Qt::ControlModifier);
    settle(*window_);
    auto* dialog = window_->findChild<ExportDialog*>();
    ASSERT_NE(dialog, nullptr) << window_->last_error().toStdString();
    QApplication::setActiveWindow(dialog);
    auto* allowed = dialog->findChild<QLineEdit*>("largest error");
    ASSERT_TRUE(tab_to(allowed));
    type("5");
    settle(*window_);
    std::vector<QWidget*> way;
    for (int i = 0; i < 60; ++i) {
        key(Qt::Key_Tab);
        QWidget* now = QApplication::focusWidget();
        ASSERT_NE(now, nullptr);
        ASSERT_EQ(now->window(), dialog) << "Tab stays in the dialog";
        way.push_back(now);
    }
    EXPECT_NE(std::find(way.begin(), way.end(), allowed), way.end()) << "Tab comes round";
    QPushButton* prove = nullptr;
    for (auto* button : dialog->findChildren<QPushButton*>()) {
        EXPECT_TRUE(!button->isEnabled() || std::find(way.begin(), way.end(), button) != way.end())
            << button->text().toStdString();
        prove = button->text() == "&Prove" ? button : prove;
    }
    ASSERT_TRUE(prove != nullptr && tab_to(prove));
    key(Qt::Key_Space);
    settle(*window_);
    EXPECT_TRUE(dialog->proof().startsWith("Compiled, run and equal")) << dialog->proof().toStdString();
    key(Qt::Key_Escape);
    settle(*window_);
    EXPECT_FALSE(dialog->isVisible());
}

// Esc in a field ended the computation of the study, and said so for four seconds.
TEST_F(ByKeyboard, EscInAFieldCancelsNothing) {
    begin(copy_of_study());
    key(Qt::Key_F2);
    settle(*window_);
    window_->jobs().start("run", "counting", [](core::Progress& progress) -> std::function<void()> {
        while (!progress.cancelled()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        throw core::Cancelled();
    });
    const auto bars = window_->findChildren<QProgressBar*>();
    ASSERT_TRUE(QTest::qWaitFor([&] {
        return std::any_of(bars.begin(), bars.end(),
                           [](auto* bar) { return bar->accessibleName() == "Progress" && bar->isVisible(); });
    }));
    auto* number = panel<DesignPanel>().findChild<ParameterRow*>("body.length")->number();
    ASSERT_TRUE(tab_to(number));
    const QString before = number->text();
    type("7");
    key(Qt::Key_Escape);
    EXPECT_EQ(number->text(), before) << "what was typed is taken back";
    key(Qt::Key_Escape);
    EXPECT_TRUE(window_->jobs().busy("run"));
    panel<DesignPanel>().findChild<ParameterRow*>("body.length")->slider()->setFocus();
    key(Qt::Key_Escape);
    EXPECT_FALSE(window_->jobs().busy("run"));
    settle(*window_);
    const auto* list = window_->findChild<ProblemList*>();
    EXPECT_TRUE(list->topLevelItem(list->topLevelItemCount() - 1)->text(1).contains("cancelled by hand: counting"));
}

}  // namespace
}  // namespace underbody::studio
