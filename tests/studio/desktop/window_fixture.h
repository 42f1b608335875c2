// The real window over a small study, without a display (Qt's `offscreen` platform).
#pragma once

#include <gtest/gtest.h>

#include <QApplication>
#include <clocale>
#include <functional>
#include <memory>

#include "studio/desktop/application.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/screenshots.h"
#include "studio/desktop/study_tree.h"
#include "tests/studio/desktop/few_gaps.h"

namespace underbody::studio {

namespace fs = std::filesystem;

/// Called before the application is made; `offscreen` draws without a display, and without 3D.
inline std::function<void()> choose_platform = [] {
    ::setenv("QT_QPA_PLATFORM", "offscreen", 1);
    ::unsetenv("DISPLAY");
};

/// One application for all tests: Qt allows no second one.
inline Application& application() {
    static int count = 1;
    static char name[] = "test_desktop";
    static char* arguments[] = {name, nullptr};
    static const bool chosen = (choose_platform(), true);
    static_cast<void>(chosen);
    static auto* instance = [] {
        auto* made = new Application(count, arguments);  // it must outlive whatever goes at the end
        made->failed = [](const std::exception_ptr& error) { ADD_FAILURE() << tell(error).message.toStdString(); };
        return made;
    }();
    std::setlocale(LC_NUMERIC, "C");
    QLocale::setDefault(QLocale::c());
    return *instance;
}

/// Computed once; tests that change it take a copy.
inline fs::path computed_study() {
    static const core::TemporaryFolder folder;
    static const fs::path study = [] {
        test::make_few_gaps(folder.path() / "study");
        const auto run = test::run_underbody({"study", "run", (folder.path() / "study").string(), "--no-pictures"});
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        return folder.path() / "study";
    }();
    return study;
}

class Window : public ::testing::Test {
protected:
    Window() {
        application();
        window_ = std::make_unique<MainWindow>(false);
        window_->ask = [this](const QString&, const QString&, const QString&) {
            ++asked_;
            return answer_;
        };
        window_->resize(1200, 800);
        window_->show();
    }
    void open(const fs::path& folder) {
        window_->open_study(folder);
        settle(*window_);
        ASSERT_TRUE(window_->has_study()) << window_->last_error().toStdString();
    }
    fs::path copy_of_study() {
        fs::copy(computed_study(), folder_.path() / "copy", fs::copy_options::recursive);
        return folder_.path() / "copy";
    }
    bool act(const std::string& line) {
        const bool done = window_->desk().act(words_of(line));
        return done;
    }
    template <class Panel>
    Panel& panel() {
        return *window_->findChild<Panel*>();
    }
    QString status_of(const std::string& name) {
        auto* tree = window_->findChild<StudyTree*>();
        StudyModel model(window_->desk(), tree);
        model.read();
        const QModelIndex at = model.find("case/" + name);
        return at.sibling(at.row(), StudyModel::status).data().toString();
    }
    core::TemporaryFolder folder_;
    std::unique_ptr<MainWindow> window_;
    bool answer_ = false;
    int asked_ = 0;
};

}  // namespace underbody::studio
