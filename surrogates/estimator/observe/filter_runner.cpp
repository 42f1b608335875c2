#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "surrogates/estimator/observe/observer.h"

namespace underbody::estimator {

namespace {

void copy(const Matrix& from, std::size_t rows, std::size_t columns, double* to, const char* what) {
    if (from.rows() != rows || from.columns() != columns) {
        throw core::InputError("shape", std::string("the filter's matrix '") + what + "' has the wrong size");
    }
    std::copy(from.data(), from.data() + rows * columns, to);
}

void copy(const Vector& from, std::size_t size, double* to, const char* what) {
    if (from.size() != size) {
        throw core::InputError("shape", std::string("the filter's vector '") + what + "' has the wrong size");
    }
    std::copy(from.begin(), from.end(), to);
}

inline void add_product(const double* m, std::size_t rows, std::size_t columns, const double* x, double* y) noexcept {
    for (std::size_t i = 0; i < rows; ++i) {
        double sum = y[i];
        for (std::size_t j = 0; j < columns; ++j) {
            sum += m[i * columns + j] * x[j];
        }
        y[i] = sum;
    }
}

}  // namespace

FilterRunner::FilterRunner(const LinearFilter& f)
    : states_(f.phi.rows()), measured_(f.measured.size()), inputs_(f.inputs.size()), outputs_(f.estimates.size()) {
    if (states_ > most_states || measured_ > most_signals || inputs_ > most_signals || outputs_ > most_states) {
        throw core::InputError("range",
                               "the filter is too large to run: at most 16 states, 8 sensors, 8 inputs, 16 estimates");
    }
    copy(f.phi, states_, states_, phi_, "phi");
    copy(f.previous, states_, measured_, previous_, "previous");
    copy(f.present, states_, measured_, present_, "present");
    copy(f.input, states_, inputs_, input_, "input");
    copy(f.constant, states_, constant_, "constant");
    copy(f.output, outputs_, states_, output_, "output");
    copy(f.feed, outputs_, measured_, feed_, "feed");
    copy(f.output_constant, outputs_, output_constant_, "output_constant");
    copy(f.start, states_, start_, "start");
    copy(f.start_feed, states_, measured_, start_feed_, "start_feed");
    std::fill(state_, state_ + most_states, 0.0);
    std::fill(last_, last_ + most_signals, 0.0);
}

void FilterRunner::start(const double* measured, double* estimates) noexcept {
    std::memcpy(state_, start_, states_ * sizeof(double));
    add_product(start_feed_, states_, measured_, measured, state_);
    std::memcpy(last_, measured, measured_ * sizeof(double));
    std::memcpy(estimates, output_constant_, outputs_ * sizeof(double));
    add_product(output_, outputs_, states_, state_, estimates);
    add_product(feed_, outputs_, measured_, measured, estimates);
}

void FilterRunner::step(const double* measured, const double* input, double* estimates) noexcept {
    double next[most_states];
    std::memcpy(next, constant_, states_ * sizeof(double));
    add_product(phi_, states_, states_, state_, next);
    add_product(previous_, states_, measured_, last_, next);
    add_product(present_, states_, measured_, measured, next);
    add_product(input_, states_, inputs_, input, next);
    std::memcpy(state_, next, states_ * sizeof(double));
    std::memcpy(last_, measured, measured_ * sizeof(double));
    std::memcpy(estimates, output_constant_, outputs_ * sizeof(double));
    add_product(output_, outputs_, states_, state_, estimates);
    add_product(feed_, outputs_, measured_, measured, estimates);
}

}  // namespace underbody::estimator
