// Work beside the window: one thread pool, progress, cancelling, and results that come back on the window's thread.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <QThreadPool>
#include <QTimer>
#include <exception>
#include <functional>
#include <list>
#include <memory>
#include <vector>

#include "core/progress.h"

namespace underbody::studio {

class Jobs : public QObject {
    Q_OBJECT
public:
    /// Runs in a worker; what it returns runs on the window's thread afterwards (and shows the result).
    using Work = std::function<std::function<void()>(core::Progress&)>;

    /// A job that runs, for the list of jobs.
    struct Row {
        int id = 0;
        QString slot;
        QString what;
        QString doing;
        double fraction = 0;
        double seconds = 0;
    };

    explicit Jobs(QObject* parent);
    ~Jobs() override;

    /// Starts work under a name for people. A newer job of the same `slot` cancels the older one, whose result is
    /// dropped. `quiet` jobs (a slider being dragged) show no progress bar. `ended` runs on the window's thread when
    /// the work is over, however it ended, after its result is shown.
    void start(const QString& slot, const QString& what, Work work, bool quiet = false,
               std::function<void()> ended = {});
    /// Cancels every job.
    void cancel();
    /// Cancels the jobs of one slot.
    void cancel(const QString& slot);
    void cancel(int id);
    [[nodiscard]] bool busy() const { return !running_.empty(); }
    /// A job of that slot runs whose result is still wanted.
    [[nodiscard]] bool busy(const QString& slot) const;
    /// Those that are not quiet and not cancelled, oldest first.
    [[nodiscard]] std::vector<Row> rows() const;

Q_SIGNALS:
    /// The rows are others, or further.
    void changed();
    /// fraction 0..1 of the oldest job that is not quiet; `what` is empty when there is none.
    void progressed(double fraction, const QString& what);
    /// A job failed with an exception other than core::Cancelled.
    void failed(const QString& what, std::exception_ptr error);
    /// A job that is not quiet came to its end with a result.
    void succeeded(const QString& what);
    void idle();

private:
    struct Job {
        int id = 0;
        QString slot;
        QString what;
        bool quiet = false;
        std::unique_ptr<core::Progress> progress;
        std::function<void()> ended;
        QElapsedTimer since;
        double fraction = 0;
        QString doing;
        bool dropped = false;  ///< superseded or cancelled: its result is not shown
    };
    template <class Which>
    void cancel_where(Which which);
    void listen(const std::shared_ptr<Job>& job);
    void finish(const std::shared_ptr<Job>& job, const std::function<void()>& show, const std::exception_ptr& error);
    void tell();

    QThreadPool pool_;
    std::list<std::shared_ptr<Job>> running_;
    QTimer rest_;  ///< runs out when nothing has run for a while
    int last_id_ = 0;
    bool closing_ = false;
};

}  // namespace underbody::studio

Q_DECLARE_METATYPE(std::exception_ptr)
