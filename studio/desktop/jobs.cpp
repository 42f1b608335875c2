#include "studio/desktop/jobs.h"

#include <QCoreApplication>
#include <QtConcurrent>
#include <atomic>
#include <chrono>

#include "core/error.h"

namespace underbody::studio {

Jobs::Jobs(QObject* parent) : QObject(parent) {
    qRegisterMetaType<std::exception_ptr>();
    pool_.setMaxThreadCount(3);
}

Jobs::~Jobs() {
    closing_ = true;
    cancel();
    // A worker may be waiting for the window's thread to draw a picture: keep answering while it winds up.
    while (!pool_.waitForDone(20)) {
        QCoreApplication::processEvents();
    }
}

void Jobs::start(const QString& slot, const QString& what, Work work, bool quiet) {
    cancel(slot);
    auto job = std::make_shared<Job>();
    job->slot = slot;
    job->what = what;
    job->quiet = quiet;
    const std::weak_ptr<Job> weak = job;
    // The listener is called from any thread and often: let a message through every 50 ms.
    auto last = std::make_shared<std::atomic<std::int64_t>>(0);
    job->progress = std::make_unique<core::Progress>([this, weak, last](double fraction, const std::string& doing) {
        const auto now =
            std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now().time_since_epoch())
                .count();
        auto then = last->load();
        if (now - then < 50 || !last->compare_exchange_strong(then, now)) {
            return;
        }
        QMetaObject::invokeMethod(
            this,
            [this, weak, fraction, text = QString::fromStdString(doing)] {
                if (const auto alive = weak.lock()) {
                    alive->fraction = fraction;
                    alive->doing = text;
                    tell();
                }
            },
            Qt::QueuedConnection);
    });
    running_.push_back(job);
    QtConcurrent::run(&pool_, [this, job, work = std::move(work)] {
        std::function<void()> show;
        std::exception_ptr error;
        try {
            job->progress->check();
            show = work(*job->progress);
        } catch (...) {
            error = std::current_exception();
        }
        QMetaObject::invokeMethod(
            this, [this, job, show, error] { finish(job, show, error); }, Qt::QueuedConnection);
    });
    tell();
}

void Jobs::finish(const std::shared_ptr<Job>& job, const std::function<void()>& show, const std::exception_ptr& error) {
    running_.remove(job);
    if (closing_) {
        return;
    }
    if (error && !job->dropped) {
        try {
            std::rethrow_exception(error);
        } catch (const core::Cancelled&) {
        } catch (...) {
            Q_EMIT failed(job->what, std::current_exception());
        }
    }
    if (!error && !job->dropped && show) {
        try {
            show();
        } catch (...) {
            Q_EMIT failed(job->what, std::current_exception());
        }
    }
    tell();
    if (running_.empty()) {
        Q_EMIT idle();
    }
}

void Jobs::cancel() {
    for (const auto& job : running_) {
        job->progress->cancel();
        job->dropped = true;
    }
}

void Jobs::cancel(const QString& slot) {
    for (const auto& job : running_) {
        if (job->slot == slot) {
            job->progress->cancel();
            job->dropped = true;
        }
    }
}

void Jobs::tell() {
    for (const auto& job : running_) {
        if (!job->quiet && !job->dropped) {
            Q_EMIT progressed(job->fraction, job->doing.isEmpty() ? job->what : job->what + ": " + job->doing);
            return;
        }
    }
    Q_EMIT progressed(1, {});
}

}  // namespace underbody::studio
