// The application: a defect in what an event does is told, and the window stays.
#pragma once

#include <QApplication>
#include <exception>
#include <functional>
#include <set>
#include <string>

namespace underbody::studio {

class Application : public QApplication {
    Q_OBJECT
public:
    using QApplication::QApplication;

    /// Called with what an event threw: once for the same words until somebody does something again, for a view that
    /// fails would fail at each repaint.
    std::function<void(const std::exception_ptr&)> failed;

    /// Of an event that throws: false, as of one that nobody wants.
    bool notify(QObject* receiver, QEvent* event) override;

private:
    std::set<std::string> told_;
};

}  // namespace underbody::studio
