// Progress and cancelling that every long function takes.
#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace underbody::core {

/// Passed by reference into long functions. Thread-safe. A default one reports nowhere and can still be cancelled.
class Progress {
public:
    /// Called with the fraction done (0..1) and what is being done; may be called from any thread.
    using Listener = std::function<void(double fraction, const std::string& what)>;

    Progress() = default;
    explicit Progress(Listener listener) : listener_(std::move(listener)) {}
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void report(double fraction, const std::string& what) {
        if (listener_) {
            listener_(fraction, what);
        }
    }

    /// May be called from a signal handler.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    [[nodiscard]] bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

    /// Throws Cancelled if someone asked for it. Call it at least every 50 ms of work.
    void check() const;

    /// The one to pass where nobody watches.
    static Progress& none();

private:
    Listener listener_;
    std::atomic<bool> cancelled_{false};
};

}  // namespace underbody::core
