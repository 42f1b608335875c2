// The dialog that exports a table for a controller: what it shows, writes, proves and refuses.
// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "surrogates/dynamics/basin/region.h"
// clang-format on

#include <gtest/gtest.h>

#include <QAction>
#include <QFileDialog>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QSignalSpy>
#include <QTest>
#include <QTimer>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <thread>

#include "core/file.h"
#include "studio/desktop/export_dialog.h"
#include "studio/desktop/export_preview.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/state/exports.h"
#include "studio/desktop/state/words.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

/// Typed by hand, per cent.
void allow_error(ExportDialog& dialog, const QString& text) {
    auto* edit = dialog.findChild<QLineEdit*>("largest error");
    ASSERT_NE(edit, nullptr);
    QTest::keyClicks(edit, text);
}

TEST_F(Window, AnExportIsShownProvedAndWritten) {
    open(computed_study());
    act("workspace tables");
    settle(*window_);
    ExportDialog* dialog = new ExportDialog(window_->jobs(), panel<ForcePanel>().table(), window_.get(),
                                            table_of_study(window_->desk().session(), "lift"));
    settle(*window_);
    const QString study = QString::fromStdString(computed_study().string());
    EXPECT_TRUE(dialog->command("lift.h").startsWith("underbody study run " + study + " && underbody export " + study +
                                                     "/report/exports/lift.csv "))
        << dialog->command("lift.h").toStdString();
    EXPECT_TRUE(dialog->command("lift.h").contains("# with \"csv\" among the exports"))
        << "the study writes no points yet";
    EXPECT_TRUE(dialog->preview().contains("#ifndef")) << dialog->preview().left(300).toStdString();
    EXPECT_FALSE(dialog->error()->isVisibleTo(dialog)) << "equal to the table";
    allow_error(*dialog, "30");
    settle(*window_);
    ASSERT_TRUE(dialog->error()->isVisibleTo(dialog));
    EXPECT_EQ(dialog->error()->figure().x.label, "gap");
    dialog->prove();
    settle(*window_);
    EXPECT_TRUE(dialog->proof().startsWith("Compiled, run and equal")) << dialog->proof().toStdString();
    EXPECT_TRUE(dialog->proof().contains("10,000 points")) << dialog->proof().toStdString();
    dialog->write(folder_.path() / "lift.h");
    settle(*window_);
    EXPECT_EQ(core::read_file(folder_.path() / "lift.h").substr(0, 40), dialog->preview().toStdString().substr(0, 40));
    delete dialog;
}

// It began in the folder that the program was started in, which may be anywhere; the note named no file.
TEST_F(Window, FilesAreWrittenIntoTheStudysFolder) {
    const fs::path study = copy_of_study();
    open(study);
    act("workspace tables");
    settle(*window_);
    auto* dialog = window_->show_export(panel<ForcePanel>().table(), table_of_study(window_->desk().session(), "lift"));
    const auto folder_asked_in = [&] {
        QString folder;
        QTimer::singleShot(200, [&folder] {
            if (auto* asks = qobject_cast<QFileDialog*>(QApplication::activeModalWidget())) {
                folder = asks->directory().absolutePath();
                asks->reject();
            }
        });
        for (auto* button : dialog->findChildren<QPushButton*>()) {
            if (button->text() == "&Write …") {
                button->click();
            }
        }
        return folder.toStdString();
    };
    EXPECT_EQ(folder_asked_in(), study.string());
    EXPECT_EQ(window_->write_folder().toStdString(), study.string());
    const fs::path elsewhere = folder_.path() / "elsewhere";
    fs::create_directories(elsewhere);
    dialog->write(elsewhere / "lift.h");
    settle(*window_);
    EXPECT_EQ(window_->write_folder().toStdString(), elsewhere.string()) << "where it was written last";
    EXPECT_TRUE(
        panel<ProblemList>().text().contains("Wrote " + QString::fromStdString((elsewhere / "lift.h").string())))
        << panel<ProblemList>().text().toStdString();
    delete dialog;
}

/// Carries out a line of commands that are joined by "&&".
void carry_out(const QString& line) {
    for (const auto& one : line.split(" && ")) {
        Words words = words_of(one.toStdString());
        ASSERT_EQ(words.front(), "underbody");
        words.erase(words.begin());
        const auto run = test::run_underbody(words);
        EXPECT_EQ(run.exit_code, 0) << one.toStdString() << "\n" << run.errors;
    }
}

// The command beside an export runs wherever the report went, and `study why` knows what the window writes.
TEST_F(Window, AnExportOfAStudysTableIsTheStudys) {
    const fs::path study = copy_of_study();
    std::string text = core::read_file(study / "study.toml");
    text.insert(text.find("net_weight"), "exports = [\"c\", \"csv\"]\n");
    core::write_file(study / "study.toml", text);
    fs::remove_all(study / "report");
    const auto run = test::run_underbody({"study", "run", study.string(), "--no-pictures", "--report",
                                          (folder_.path() / "elsewhere" / "index.html").string()});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    open(study);
    act("workspace tables");
    settle(*window_);
    const auto dialog_of = [&] {
        return new ExportDialog(window_->jobs(), panel<ForcePanel>().table(), window_.get(),
                                table_of_study(window_->desk().session(), "lift"));
    };
    auto* dialog = dialog_of();
    const QString by_command = QString::fromStdString((folder_.path() / "by_command.h").string());
    const fs::path by_window = folder_.path() / "by_window.h";
    EXPECT_TRUE(dialog->command(by_command).startsWith("underbody study run ")) << "its points stand elsewhere";
    carry_out(dialog->command(by_command));
    EXPECT_TRUE(fs::exists(by_command.toStdString()));
    dialog->write(by_window);
    settle(*window_);
    delete dialog;
    dialog = dialog_of();
    EXPECT_TRUE(dialog->command(by_command).startsWith("underbody export ")) << "they are there now";
    delete dialog;
    EXPECT_EQ(core::read_file(by_window), core::read_file(study / "report" / "exports" / "lift.h"));
    const auto why = test::run_underbody({"study", "why", study.string(), by_window.string()});
    EXPECT_EQ(why.exit_code, 0) << why.errors;
    EXPECT_EQ(why.output.find("differs"), std::string::npos) << why.output;
    core::write_file(study / "report" / "exports" / "lift.csv", "points of another run");
    EXPECT_FALSE(table_of_study(window_->desk().session(), "lift").first.empty()) << "not those of the table as it is";
}

// What is wrong stands in the dialog (it stood behind it), and says what a number is written with.
TEST_F(Window, TheExportDialogSaysWhatIsWrong) {
    open(computed_study());
    act("workspace tables");
    settle(*window_);
    auto* dialog = new ExportDialog(window_->jobs(), panel<ForcePanel>().table(), window_.get());
    settle(*window_);
    allow_error(*dialog, "0,5");
    settle(*window_);
    const auto labels = dialog->findChildren<QLabel*>();
    EXPECT_TRUE(std::any_of(labels.begin(), labels.end(),
                            [](const QLabel* label) { return label->text().contains("decimal point: 0.5"); }));
    dialog->prove();
    EXPECT_TRUE(dialog->proof().startsWith("Not proved")) << dialog->proof().toStdString();
    dialog->write_to(QString::fromStdString((folder_.path() / "lift.h").string()));
    EXPECT_TRUE(dialog->proof().startsWith("Not written")) << dialog->proof().toStdString();
    EXPECT_TRUE(window_->last_error().isEmpty()) << window_->last_error().toStdString();
    delete dialog;
}

// It runs beside the window, says how far it is, and the same button stops it.
TEST_F(Window, AProofIsStoppedByItsButton) {
    open(computed_study());
    act("workspace tables");
    settle(*window_);
    auto* dialog = new ExportDialog(window_->jobs(), panel<ForcePanel>().table(), window_.get());
    dialog->show();
    settle(*window_);
    QPushButton* prove = nullptr;
    for (auto* button : dialog->findChildren<QPushButton*>()) {
        prove = button->text().contains("rove") ? button : prove;
    }
    ASSERT_NE(prove, nullptr);
    QSignalSpy said(dialog, &ExportDialog::proved);
    prove->click();
    auto* bar = dialog->findChild<QProgressBar*>();
    ASSERT_NE(bar, nullptr);
    EXPECT_TRUE(bar->isVisible());
    EXPECT_TRUE(prove->text().contains("Sto")) << prove->text().toStdString();
    QTest::qWait(30);
    prove->click();
    EXPECT_FALSE(bar->isVisible());
    EXPECT_EQ(dialog->proof(), "Not proved: stopped");
    settle(*window_);
    EXPECT_EQ(said.count(), 0);
    EXPECT_TRUE(prove->text().contains("Prove"));
    prove->click();
    settle(*window_);
    EXPECT_EQ(said.count(), 1);
    EXPECT_TRUE(said[0][0].toBool()) << dialog->proof().toStdString();
    delete dialog;
}

/// The study with a second table, and how both are exported.
fs::path with_drag(const fs::path& study) {
    std::string text = core::read_file(study / "study.toml");
    text.insert(text.find("[[region]]"),
                "[[table]]\nname = \"drag, level\"\nquantity = \"drag_force\"\naxes = [\"gap\"]\n"
                "where = { variant = \"ellipse\", pitch = 0, speed = \"0.5 m/s\" }\nexports = [\"csv\"]\n\n");
    text.insert(text.find("net_weight"), "exports = [\"csv\"]\n");
    core::write_file(study / "study.toml", text);
    return study;
}

// All marked tables are one action: one question, one step, one line.
TEST_F(Window, AllMarkedTablesAreWritten) {
    const fs::path study = with_drag(copy_of_study()), out = folder_.path() / "out";
    fs::create_directories(out);
    open(study);
    act("workspace tables");
    act("select table/lift");
    act("star 'table/drag, level'");
    settle(*window_);
    for (auto* action : window_->actions()) {
        if (action->shortcut() == QKeySequence("Ctrl+E")) {
            action->trigger();
        }
    }
    settle(*window_);
    auto* dialog = window_->findChild<ExportDialog*>();
    ASSERT_NE(dialog, nullptr) << window_->last_error().toStdString();
    const auto button = [&] {
        for (auto* one : dialog->findChildren<QPushButton*>()) {
            if (one->text().contains("marked")) {
                return one;
            }
        }
        return static_cast<QPushButton*>(nullptr);
    };
    ASSERT_NE(button(), nullptr);
    EXPECT_EQ(button()->text().toStdString(), "Write &all 2 marked …");
    const ExportRecord how = dialog->record();
    delete dialog;
    const auto steps = window_->desk().history().steps().size();
    core::write_file(out / "lift.h", "somebody's own\n");
    EXPECT_FALSE(window_->write_marked(how, out));
    EXPECT_EQ(asked_, 1);
    EXPECT_EQ(core::read_file(out / "lift.h"), "somebody's own\n") << "never replaced unasked";
    EXPECT_FALSE(fs::exists(out / "drag__level.h"));
    answer_ = true;
    EXPECT_TRUE(window_->write_marked(how, out));
    settle(*window_);
    const auto& history = window_->desk().history();
    ASSERT_EQ(history.steps().size(), steps + 1) << window_->last_error().toStdString();
    EXPECT_EQ(history.steps().back().name, "export lift.h and 1 more");
    const auto& exports = window_->desk().state().exports;
    ASSERT_EQ(exports.size(), 2U);
    std::vector<std::string> files;
    for (const auto& [file, record] : exports) {
        files.push_back(file);
        EXPECT_NE(core::read_file(file).find("#ifndef"), std::string::npos) << file;
    }
    EXPECT_TRUE(foreign_files(window_->desk().state(), files).empty());
    EXPECT_TRUE(stale_exports(window_->desk().state(), window_->desk().session()).empty());
    window_->desk().undo();
    EXPECT_TRUE(window_->desk().state().exports.empty()) << "one step";
    window_->desk().redo();
    EXPECT_EQ(window_->desk().state().exports.size(), 2U);
    EXPECT_TRUE(window_->write_marked(how, out));
    settle(*window_);
    EXPECT_EQ(asked_, 2) << "its own files are not asked for";
    // The line does the same.
    const QString command = QString::fromStdString(history.steps().back().command);
    EXPECT_EQ(command.count("underbody export "), 2) << command.toStdString();
    EXPECT_EQ(command.count("study run"), 1) << command.toStdString();
    std::map<std::string, std::string> texts;
    for (const auto& file : files) {
        texts[file] = core::read_file(file);
        fs::remove(file);
    }
    carry_out(command.section("  # ", 0, 0));
    const auto numbers = [](const std::string& text) { return text.substr(text.find("#ifndef")); };
    for (const auto& file : files) {
        ASSERT_TRUE(fs::exists(file)) << command.toStdString();
        EXPECT_EQ(numbers(core::read_file(file)), numbers(texts[file])) << file;
    }
}

// "Wrote" is said when it is, and a write that is stopped says so.
TEST_F(Window, AnExportIsSaidToBeWrittenWhenItIs) {
    open(computed_study());
    act("workspace tables");
    settle(*window_);
    const auto go = std::make_shared<std::atomic<bool>>(true);
    const auto table = panel<ForcePanel>().table();
    auto* dialog = new ExportDialog(window_->jobs(), table, window_.get(), {},
                                    [go, table](const auto& range, core::Progress& progress) {
                                        while (!*go) {
                                            progress.check();
                                            std::this_thread::sleep_for(std::chrono::milliseconds(1));
                                        }
                                        return refitted(*table, range);
                                    });
    settle(*window_);
    *go = false;
    const fs::path file = folder_.path() / "lift.h";
    dialog->write_to(QString::fromStdString(file.string()));
    QTest::qWait(20);
    EXPECT_EQ(dialog->proof(), "writing …");
    window_->jobs().cancel();
    settle(*window_);
    EXPECT_EQ(dialog->proof(), "Not written: stopped");
    EXPECT_FALSE(fs::exists(file));
    dialog->write_to(QString::fromStdString(file.string()));
    *go = true;
    settle(*window_);
    EXPECT_EQ(dialog->proof().toStdString(), "Wrote " + file.string());
    EXPECT_TRUE(fs::exists(file));
    delete dialog;
}

// What a closed dialog was writing is a step of the history, and is told.
TEST_F(Window, AnExportOfAClosedDialogIsKept) {
    open(copy_of_study());
    act("workspace tables");
    act("select table/lift");
    settle(*window_);
    for (auto* action : window_->actions()) {
        if (action->shortcut() == QKeySequence("Ctrl+E")) {
            action->trigger();
        }
    }
    settle(*window_);
    auto* dialog = window_->findChild<ExportDialog*>();
    ASSERT_NE(dialog, nullptr) << window_->last_error().toStdString();
    const auto steps = window_->desk().history().steps().size();
    const fs::path file = folder_.path() / "lift.h";
    dialog->write(file);
    dialog->close();
    QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);  // as the loop of the program does at once
    settle(*window_);
    QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
    EXPECT_EQ(window_->findChild<ExportDialog*>(), nullptr) << "it is gone then";
    ASSERT_TRUE(fs::exists(file));
    ASSERT_EQ(window_->desk().history().steps().size(), steps + 1);
    EXPECT_EQ(window_->desk().state().exports.count(file.string()), 1U);
    EXPECT_TRUE(stale_exports(window_->desk().state(), window_->desk().session()).empty());
}

// They stopped one another's previews and proofs.
TEST_F(Window, TwoExportDialogsDoNotStopEachOther) {
    open(computed_study());
    act("workspace tables");
    settle(*window_);
    auto* one = new ExportDialog(window_->jobs(), panel<ForcePanel>().table(), window_.get());
    auto* other = new ExportDialog(window_->jobs(), panel<ForcePanel>().table(), window_.get());
    settle(*window_);
    EXPECT_FALSE(one->preview().isEmpty());
    EXPECT_FALSE(other->preview().isEmpty());
    one->prove();
    other->prove();
    settle(*window_);
    for (auto* dialog : {one, other}) {
        EXPECT_TRUE(dialog->proof().startsWith("Compiled, run and equal")) << dialog->proof().toStdString();
        delete dialog;
    }
}

TEST_F(Window, TheErrorAllowedIsPerCentHoweverItIsTyped) {
    open(computed_study());
    act("workspace tables");
    settle(*window_);
    auto* dialog = new ExportDialog(window_->jobs(), panel<ForcePanel>().table(), window_.get());
    for (const char* text : {"5", "5%", "5 %", "5 percent"}) {
        dialog->findChild<QLineEdit*>("largest error")->setText(text);
        EXPECT_DOUBLE_EQ(dialog->record().max_error.value_or(0), 0.05) << text;
    }
    dialog->findChild<QLineEdit*>("largest error")->setText("5 mm");
    EXPECT_THROW(dialog->record(), core::InputError);
    delete dialog;
}

// One that cannot be written does not take the others with it.
TEST_F(Window, MarkedTablesAreWrittenThoughOneFails) {
    const fs::path out = folder_.path() / "out";
    open(with_drag(copy_of_study()));
    act("workspace tables");
    act("select table/lift 'table/drag, level'");
    settle(*window_);
    fs::create_directories(out / "lift.h" / "a folder of that name");
    answer_ = true;
    ExportRecord how;
    how.format = "c";
    how.frame = "up";
    how.number = "double";
    const auto steps = window_->desk().history().steps().size();
    EXPECT_TRUE(window_->write_marked(how, out));
    settle(*window_);
    EXPECT_TRUE(fs::exists(out / "drag__level.h"));
    ASSERT_EQ(window_->desk().history().steps().size(), steps + 1);
    const auto& exports = window_->desk().state().exports;
    ASSERT_EQ(exports.size(), 1U);
    EXPECT_EQ(exports.begin()->second.table, "drag, level");
    EXPECT_TRUE(window_->last_error().contains("lift.h")) << window_->last_error().toStdString();
    auto* banner = window_->findChild<Banner*>();
    ASSERT_NE(banner, nullptr);
    EXPECT_TRUE(banner->isVisibleTo(window_.get())) << "it says which, and why";
}

}  // namespace
}  // namespace underbody::studio
