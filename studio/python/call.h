// One call from Python into the libraries: the interpreter goes on meanwhile, Ctrl-C and progress reach it.
#pragma once

#include <pybind11/pybind11.h>

#include <csignal>
#include <exception>
#include <functional>
#include <mutex>
#include <string>

#include "core/error.h"
#include "core/progress.h"

namespace underbody::python {

namespace py = pybind11;

/// While it lives, SIGINT cancels a progress and goes on to the handler that was there (Python's). One at a time, on
/// the main thread; on others Python takes no signals and it does nothing.
class Interruptible {
public:
    explicit Interruptible(core::Progress& progress);
    ~Interruptible();
    Interruptible(const Interruptible&) = delete;
    Interruptible& operator=(const Interruptible&) = delete;

private:
    bool active_;
    struct sigaction before_ {};
};

/// The progress of a call, told to a Python function(fraction, what) or to nobody. An exception of that function
/// cancels the call and comes out of it.
class Call {
public:
    /// `listener`: a function or None.
    explicit Call(const py::object& listener);

    core::Progress& progress() { return progress_; }
    core::Progress::Listener listener();

    /// Runs `work` without the interpreter's lock. `progress`: the one that the work looks at.
    void run(core::Progress& progress, const std::function<void()>& work);

private:
    void tell(double fraction, const std::string& what);
    py::object function_;
    core::Progress* watched_ = nullptr;
    core::Progress progress_;
    std::mutex mutex_;
    std::exception_ptr failure_;
    double last_ = -1;
};

/// Raises the Python class of that name ("InputError", ...) with the error's parts as attributes.
void raise(const std::string& class_name, const core::Error& error);

}  // namespace underbody::python
