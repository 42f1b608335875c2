// Ordinary differential equations by SUNDIALS CVODE with events, behind a thin door.
#pragma once

#include <functional>
#include <memory>
#include <vector>

namespace underbody::dynamics {

struct OdeProblem {
    std::size_t size = 0;
    std::function<void(double t, const double* y, double* rate)> rate;
    /// Functions whose zeros stop the integrator; `direction`: -1 falling, +1 rising, 0 both.
    std::function<void(double t, const double* y, double* g)> events;
    std::vector<int> direction;
};

struct OdeOptions {
    double relative = 1e-9;
    std::vector<double> absolute;  ///< one per state
    double max_step = 0;           ///< 0: as large as the error allows
    long max_steps = 2000000;
};

/// One trajectory. Not for use from several threads at once.
class Ode {
public:
    Ode(OdeProblem problem, OdeOptions options);
    ~Ode();
    Ode(const Ode&) = delete;
    Ode& operator=(const Ode&) = delete;

    /// (Re)starts at a time and state; also after an impact has changed the state.
    void start(double t, const std::vector<double>& y);

    struct Stop {
        double t = 0;
        bool event = false;
        std::vector<int> which;  ///< one per event function: 0, or the direction of its crossing
    };
    /// To `t_end` or to the first event. Throws core::Error (kind "integration") when the step becomes too small or a
    /// value is not finite.
    Stop advance(double t_end);
    /// One step of the integrator's own, not beyond `t_end`, or to the first event.
    Stop one_step(double t_end);

    [[nodiscard]] const double* state() const;
    [[nodiscard]] long steps() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace underbody::dynamics
