// How long the window's thread is away from its loop.
#pragma once

#include <time.h>

#include <QAbstractEventDispatcher>
#include <QObject>
#include <algorithm>

namespace underbody::studio {

/// Processor time of the thread that asks, s.
inline double thread_time() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Processor time that the window's thread spends without coming back to its loop, at most: what other programs do on
/// the machine does not count.
class Heartbeat : public QObject {
public:
    Heartbeat() {
        auto* dispatcher = QAbstractEventDispatcher::instance();
        connect(dispatcher, &QAbstractEventDispatcher::awake, this, [this] { beat(); });
        connect(dispatcher, &QAbstractEventDispatcher::aboutToBlock, this, [this] { beat(); });
        last_ = thread_time();
    }
    [[nodiscard]] double longest() const { return longest_; }
    void begin_anew() {
        longest_ = 0;
        last_ = thread_time();
    }

private:
    void beat() {
        const double time = thread_time();
        longest_ = std::max(longest_, time - last_);
        last_ = time;
    }
    double last_ = 0, longest_ = 0;
};

}  // namespace underbody::studio
