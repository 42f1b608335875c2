// Clocks, memory and gaps of the event loop, as bench_desktop tells them.
#pragma once

#include <unistd.h>

#include <QApplication>
#include <QElapsedTimer>
#include <QTimer>
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>

namespace underbody::studio {

/// Since the process was started, s.
inline double age() {
    std::ifstream file("/proc/self/stat");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    std::istringstream rest(text.substr(text.rfind(')') + 2));
    std::string word;
    for (int i = 0; i < 20; ++i) {
        rest >> word;
    }
    timespec now{};
    ::clock_gettime(CLOCK_BOOTTIME, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) -
           std::stod(word) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// Resident, and the part of it that belongs to this process alone, MB.
inline std::array<double, 2> memory() {
    std::ifstream file("/proc/self/status");
    std::array<double, 2> found{};
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("VmRSS:")) {
            found[0] = std::stod(line.substr(6)) / 1024;
        } else if (line.starts_with("RssAnon:")) {
            found[1] = std::stod(line.substr(8)) / 1024;
        }
    }
    return found;
}

inline void say_memory(const char* what, double goal) {
    const auto [all, own] = memory();
    std::printf("memory, %-32s %8.0f MB    (goal %.0f; %.0f of it not of libraries)\n", what, all, goal, own);
}

inline void say(const std::string& what, double seconds, const std::string& goal) {
    std::printf("%-40s %8.0f ms    (goal %s)\n", what.c_str(), 1000 * seconds, goal.c_str());
    std::fflush(stdout);
}

/// Of the thread that asks, s.
inline double thread_time() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Gap {
    double clock = 0;      ///< s
    double processor = 0;  ///< s of the window's thread in the gap that had most of it: beside other work, too
};

/// Longest time by the clock that a timer of 2 ms was not served, the period taken off: everything that keeps the
/// window's thread from its loop, whichever loop it is.
class ClockBeat : public QObject {
public:
    ClockBeat() {
        timer_.setTimerType(Qt::PreciseTimer);
        connect(&timer_, &QTimer::timeout, this, [this] {
            longest_.clock = std::max(longest_.clock, 1e-9 * static_cast<double>(time_.nsecsElapsed()) - 0.002);
            longest_.processor = std::max(longest_.processor, thread_time() - used_);
            restart();
        });
        timer_.start(2);
        restart();
    }
    Gap take() {
        QApplication::processEvents();
        const Gap longest = longest_;
        QApplication::processEvents();
        longest_ = {};
        restart();
        return longest;
    }

private:
    void restart() {
        time_.restart();
        used_ = thread_time();
    }
    QTimer timer_;
    QElapsedTimer time_;
    double used_ = 0;
    Gap longest_;
};

inline void say(const std::string& what, const Gap& gap, const std::string& goal) {
    std::printf("%-40s %8.0f ms    (goal %s; %.0f ms of the thread's processor time)\n", what.c_str(), 1000 * gap.clock,
                goal.c_str(), 1000 * gap.processor);
    std::fflush(stdout);
}

/// Processor time of the process, s.
inline double process_time() {
    timespec time{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Until it is so, in seconds; at most a minute.
template <class Done>
inline double until(Done done) {
    QElapsedTimer time;
    time.start();
    while (!done() && time.elapsed() < 60000) {
        QApplication::processEvents(QEventLoop::WaitForMoreEvents | QEventLoop::AllEvents, 2);
    }
    return 1e-9 * static_cast<double>(time.nsecsElapsed());
}

}  // namespace underbody::studio
