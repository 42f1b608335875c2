#include "studio/desktop/jobs.h"

#include <malloc.h>

#include <QCoreApplication>
#include <QtConcurrent>
#include <algorithm>
#include <atomic>
#include <chrono>

#include "core/error.h"

namespace underbody::studio {

Jobs::Jobs(QObject* parent) : QObject(parent) {
    qRegisterMetaType<std::exception_ptr>();
    pool_.setMaxThreadCount(3);
    rest_.setSingleShot(true);
    rest_.setInterval(1000);
    // What the work took in small pieces the C library keeps for more of them, although it is free.
    connect(&rest_, &QTimer::timeout, this, [] { ::malloc_trim(0); });
}

Jobs::~Jobs() {
    closing_ = true;
    cancel();
    // A worker may be waiting for the window's thread to draw a picture: keep answering while it winds up.
    while (!pool_.waitForDone(20)) {
        QCoreApplication::processEvents();
    }
}

void Jobs::listen(const std::shared_ptr<Job>& job) {
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
}

void Jobs::start(const QString& slot, const QString& what, Work work, bool quiet, std::function<void()> ended) {
    cancel(slot);
    auto job = std::make_shared<Job>();
    job->id = ++last_id_;
    job->slot = slot;
    job->what = what;
    job->quiet = quiet;
    job->ended = std::move(ended);
    job->since.start();
    listen(job);
    running_.push_back(job);
    rest_.stop();
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
    try {
        if (error && !job->dropped) {
            std::rethrow_exception(error);
        }
        if (!error && !job->dropped && show) {
            show();
            if (!job->quiet) {
                Q_EMIT succeeded(job->what);
            }
        }
    } catch (const core::Cancelled&) {
    } catch (...) {
        Q_EMIT failed(job->what, std::current_exception());
    }
    if (job->ended) {
        job->ended();
    }
    tell();
    if (running_.empty()) {
        rest_.start();
        Q_EMIT idle();
    }
}

template <class Which>
void Jobs::cancel_where(Which which) {
    bool any = false;
    for (const auto& job : running_) {
        if (!job->dropped && which(*job)) {
            job->progress->cancel();
            job->dropped = true;
            any = true;
        }
    }
    if (any && !closing_) {
        tell();
    }
}

void Jobs::cancel() {
    cancel_where([](const Job&) { return true; });
}

void Jobs::cancel(const QString& slot) {
    cancel_where([&](const Job& job) { return job.slot == slot; });
}

void Jobs::cancel(int id) {
    cancel_where([&](const Job& job) { return job.id == id; });
}

bool Jobs::busy(const QString& slot) const {
    return std::any_of(running_.begin(), running_.end(),
                       [&](const auto& job) { return job->slot == slot && !job->dropped; });
}

std::vector<Jobs::Row> Jobs::rows() const {
    std::vector<Row> rows;
    for (const auto& job : running_) {
        if (!job->quiet && !job->dropped) {
            rows.push_back({job->id, job->slot, job->what, job->doing, job->fraction,
                            static_cast<double>(job->since.elapsed()) / 1000});
        }
    }
    return rows;
}

void Jobs::tell() {
    Q_EMIT changed();
    const auto all = rows();
    if (all.empty()) {
        Q_EMIT progressed(1, {});
    } else {
        const Row& first = all.front();
        Q_EMIT progressed(first.fraction, first.doing.isEmpty() ? first.what : first.what + ": " + first.doing);
    }
}

}  // namespace underbody::studio
