// What every motion through time has in common: the integrator, rows at the step that is asked for, events, the samples
// of a digital controller.
#pragma once

#include <vector>

#include "core/no_limit.h"
#include "core/progress.h"
#include "surrogates/dynamics/simulate/ode.h"

namespace underbody::dynamics {

/// A motion says how its states change, what stops it and what a row holds.
class MotionDriver {
public:
    struct Settings {
        std::size_t states = 0, events = 4;
        double duration = 0;
        double output_step = 0;                   ///< s; 0: a row after each step of the integrator
        double tolerance = 1e-9;                  ///< relative
        double absolute = 1e-3;                   ///< times the relative tolerance
        double max_step = 0;                      ///< of the integrator, s; 0: any
        double longest_advance = core::no_limit;  ///< s, between two calls of `accept`
        double sampling = 0;                      ///< s, of a digital controller; 0: none
    };

    MotionDriver() = default;
    MotionDriver(const MotionDriver&) = delete;
    MotionDriver& operator=(const MotionDriver&) = delete;
    virtual ~MotionDriver() = default;

protected:
    Settings settings;

    /// From (t0, y) over the duration, or until an event ends it.
    void run(double t0, std::vector<double> y, core::Progress& progress);
    /// The first row behind a time, s.
    [[nodiscard]] double row_after(double t) const { return next_after(t, settings.output_step); }
    [[nodiscard]] double end() const { return begin_ + settings.duration; }
    /// When the piece of the motion between two events began, s.
    [[nodiscard]] double piece_began() const { return piece_began_; }
    /// The contact comes and goes without the motion getting on.
    [[noreturn]] static void refuse_chatter(double t);

    virtual void rates(double t, const double* y, double* rate) = 0;
    /// Functions whose fall through zero stops the integrator.
    virtual void events(double t, const double* y, double* g) = 0;
    virtual void record(double t, const double* y) = 0;
    /// What an event does to the state; false when it ends the motion.
    virtual bool after(const Ode::Stop& stop, double t, std::vector<double>& y) = 0;
    /// Before each piece; may move time and state on.
    virtual void begin_piece(double&, std::vector<double>&, core::Progress&) {}
    /// An accepted step ends here.
    virtual void accept(double, const double*) {}
    /// The controller's next sample; a row at that time comes after it.
    virtual void sample(double, const std::vector<double>&) {}

private:
    [[nodiscard]] double next_after(double t, double step) const;
    Ode::Stop follow(Ode& ode, double& t, core::Progress& progress);
    double begin_ = 0, piece_began_ = 0;
};

}  // namespace underbody::dynamics
