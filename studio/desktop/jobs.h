// Work beside the window: one thread pool, progress, cancelling, and results that come back on the window's thread.
#pragma once

#include <QObject>
#include <QString>
#include <QThreadPool>
#include <exception>
#include <functional>
#include <list>
#include <memory>

#include "core/progress.h"

namespace underbody::studio {

class Jobs : public QObject {
    Q_OBJECT
public:
    /// Runs in a worker; what it returns runs on the window's thread afterwards (and shows the result).
    using Work = std::function<std::function<void()>(core::Progress&)>;

    explicit Jobs(QObject* parent);
    ~Jobs() override;

    /// Starts work under a name for people. A newer job of the same `slot` cancels the older one, whose result is
    /// dropped. `quiet` jobs (a slider being dragged) show no progress bar.
    void start(const QString& slot, const QString& what, Work work, bool quiet = false);
    /// Cancels every job.
    void cancel();
    /// Cancels the jobs of one slot.
    void cancel(const QString& slot);
    [[nodiscard]] bool busy() const { return !running_.empty(); }

Q_SIGNALS:
    /// fraction 0..1 of the oldest job that is not quiet; `what` is empty when there is none.
    void progressed(double fraction, const QString& what);
    /// A job failed with an exception other than core::Cancelled.
    void failed(const QString& what, std::exception_ptr error);
    void idle();

private:
    struct Job {
        QString slot;
        QString what;
        bool quiet = false;
        std::unique_ptr<core::Progress> progress;
        double fraction = 0;
        QString doing;
        bool dropped = false;  ///< superseded or cancelled: its result is not shown
    };
    void finish(const std::shared_ptr<Job>& job, const std::function<void()>& show, const std::exception_ptr& error);
    void tell();

    QThreadPool pool_;
    std::list<std::shared_ptr<Job>> running_;
    bool closing_ = false;
};

}  // namespace underbody::studio

Q_DECLARE_METATYPE(std::exception_ptr)
