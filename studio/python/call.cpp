#include "studio/python/call.h"

#include <pthread.h>

#include <chrono>

#include "studio/cli/option_words.h"

namespace underbody::python {

namespace {

core::Progress* interrupted = nullptr;
struct sigaction python_handler {};

extern "C" void on_interrupt_in_python(int signal) {
    if (interrupted != nullptr) {
        interrupted->cancel();
    }
    if ((python_handler.sa_flags & SA_SIGINFO) == 0 && python_handler.sa_handler != SIG_DFL &&
        python_handler.sa_handler != SIG_IGN) {
        python_handler.sa_handler(signal);
    }
}

bool on_main_thread() {
    const py::module_ threading = py::module_::import("threading");
    return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

Interruptible::Interruptible(core::Progress& progress) : active_(on_main_thread() && interrupted == nullptr) {
    if (active_) {
        interrupted = &progress;
        struct sigaction ours {};
        ours.sa_handler = on_interrupt_in_python;
        ::sigemptyset(&ours.sa_mask);
        ::sigaction(SIGINT, nullptr, &before_);
        // Who ignores SIGINT, or has no Python handler, keeps that.
        active_ =
            (before_.sa_flags & SA_SIGINFO) == 0 && before_.sa_handler != SIG_IGN && before_.sa_handler != SIG_DFL;
        if (active_) {
            python_handler = before_;
            ::sigaction(SIGINT, &ours, nullptr);
        } else {
            interrupted = nullptr;
        }
    }
}

Interruptible::~Interruptible() {
    if (active_) {
        ::sigaction(SIGINT, &before_, nullptr);
        interrupted = nullptr;
    }
}

Call::Call(const py::object& listener) : function_(listener), progress_(this->listener()) {}

core::Progress::Listener Call::listener() {
    if (function_.is_none()) {
        return {};
    }
    return [this](double fraction, const std::string& what) { tell(fraction, what); };
}

void Call::tell(double fraction, const std::string& what) {
    {
        const std::lock_guard lock(mutex_);
        if (failure_ || (fraction < 1 && seconds() - last_ < 0.05)) {
            return;  // twenty times a second are enough for a person
        }
        last_ = seconds();
    }
    const py::gil_scoped_acquire locked;
    try {
        function_(fraction, what);
    } catch (...) {
        const std::lock_guard lock(mutex_);
        failure_ = std::current_exception();
        watched_->cancel();
    }
}

void Call::run(core::Progress& progress, const std::function<void()>& work) {
    watched_ = &progress;
    const Interruptible interruptible(progress);
    std::exception_ptr thrown;
    {
        const py::gil_scoped_release released;
        try {
            work();
        } catch (...) {
            thrown = std::current_exception();
        }
    }
    if (failure_) {
        std::rethrow_exception(std::exchange(failure_, nullptr));
    }
    if (PyErr_CheckSignals() != 0) {
        throw py::error_already_set();  // KeyboardInterrupt
    }
    if (thrown) {
        std::rethrow_exception(thrown);
    }
}

void raise(const std::string& class_name, const core::Error& error) {
    const py::object type = py::module_::import("underbody._errors").attr(class_name.c_str());
    const core::Place& place = error.place();
    const auto number = [](const auto& value) { return value ? py::object(py::int_(*value)) : py::object(py::none()); };
    const py::object exception = type(studio::with_flags(error.what()), py::arg("kind") = error.kind(),
                                      py::arg("problem") = studio::with_flags(error.message()),
                                      py::arg("hint") = studio::with_flags(error.hint()), py::arg("file") = place.file,
                                      py::arg("line") = number(place.line), py::arg("column") = number(place.column),
                                      py::arg("byte") = number(place.byte));
    PyErr_SetObject(type.ptr(), exception.ptr());
}

}  // namespace underbody::python
