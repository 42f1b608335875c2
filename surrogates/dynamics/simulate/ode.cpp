#include "surrogates/dynamics/simulate/ode.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <cmath>
#include <string>

#include "core/error.h"
#include "core/text.h"

namespace underbody::dynamics {

struct Ode::Impl {
    OdeProblem problem;
    OdeOptions options;
    SUNContext context = nullptr;
    N_Vector y = nullptr;
    N_Vector tolerance = nullptr;
    SUNMatrix matrix = nullptr;
    SUNLinearSolver solver = nullptr;
    void* memory = nullptr;
    std::vector<int> found;
    double last = 0;  ///< time of `y`

    ~Impl() {
        if (memory) {
            CVodeFree(&memory);
        }
        if (solver) {
            SUNLinSolFree(solver);
        }
        if (matrix) {
            SUNMatDestroy(matrix);
        }
        if (tolerance) {
            N_VDestroy(tolerance);
        }
        if (y) {
            N_VDestroy(y);
        }
        if (context) {
            SUNContext_Free(&context);
        }
    }

    static int rate(realtype t, N_Vector y, N_Vector out, void* user) {
        auto* self = static_cast<Impl*>(user);
        double* values = N_VGetArrayPointer(out);
        self->problem.rate(t, N_VGetArrayPointer(y), values);
        for (std::size_t i = 0; i < self->problem.size; ++i) {
            if (!std::isfinite(values[i])) {
                return 1;  // recoverable: the integrator tries a smaller step
            }
        }
        return 0;
    }

    static int events(realtype t, N_Vector y, realtype* g, void* user) {
        static_cast<Impl*>(user)->problem.events(t, N_VGetArrayPointer(y), g);
        return 0;
    }

    void check(int flag, double t) const {
        if (flag < 0) {
            char* name = CVodeGetReturnFlagName(flag);
            const std::string what = name ? name : "unknown";
            free(name);
            throw core::Error("integration",
                              "the integrator gave up at t = " + core::format_number(t, 6) + " s (" + what + ")", {},
                              "the motion is too stiff or not finite there: look at the forces near that state");
        }
    }

    Stop go(double t_end, int task) {
        Stop stop;
        CVodeSetStopTime(memory, t_end);
        realtype reached = 0;
        int flag = CVode(memory, t_end, y, &reached, task);
        if (flag == CV_ILL_INPUT) {
            // An event function that stays near zero right after an event: start afresh from here, where it counts as
            // passed.
            CVodeReInit(memory, last, y);
            CVodeSetStopTime(memory, t_end);
            flag = CVode(memory, t_end, y, &reached, task);
        }
        check(flag, reached);
        stop.t = reached;
        last = reached;
        if (flag == CV_ROOT_RETURN) {
            stop.event = true;
            stop.which.assign(problem.direction.size(), 0);
            CVodeGetRootInfo(memory, stop.which.data());
        }
        return stop;
    }
};

Ode::Ode(OdeProblem problem, OdeOptions options) : impl_(std::make_unique<Impl>()) {
    impl_->problem = std::move(problem);
    impl_->options = std::move(options);
    Impl& m = *impl_;
    const auto size = static_cast<sunindextype>(m.problem.size);
    SUNContext_Create(nullptr, &m.context);
    m.y = N_VNew_Serial(size, m.context);
    m.tolerance = N_VNew_Serial(size, m.context);
    for (std::size_t i = 0; i < m.problem.size; ++i) {
        N_VGetArrayPointer(m.tolerance)[i] =
            i < m.options.absolute.size() ? m.options.absolute[i] : m.options.relative * 1e-3;
        N_VGetArrayPointer(m.y)[i] = 0;
    }
    m.memory = CVodeCreate(CV_BDF, m.context);
    if (!m.memory || CVodeInit(m.memory, &Impl::rate, 0.0, m.y) != CV_SUCCESS) {
        throw core::SystemError("integration", "the integrator could not be set up");
    }
    CVodeSetErrFile(m.memory, nullptr);
    CVodeSetUserData(m.memory, &m);
    CVodeSVtolerances(m.memory, m.options.relative, m.tolerance);
    CVodeSetMaxNumSteps(m.memory, m.options.max_steps);
    constexpr int failures = 40;  // of one step in a row: as many halve a second to the width of a jump
    CVodeSetMaxErrTestFails(m.memory, failures);
    m.matrix = SUNDenseMatrix(size, size, m.context);
    m.solver = SUNLinSol_Dense(m.y, m.matrix, m.context);
    CVodeSetLinearSolver(m.memory, m.solver, m.matrix);
    if (m.options.max_step > 0) {
        CVodeSetMaxStep(m.memory, m.options.max_step);
    }
    if (!m.problem.direction.empty()) {
        CVodeRootInit(m.memory, static_cast<int>(m.problem.direction.size()), &Impl::events);
        CVodeSetRootDirection(m.memory, m.problem.direction.data());
        CVodeSetNoInactiveRootWarn(m.memory);
    }
}

Ode::~Ode() = default;

void Ode::start(double t, const std::vector<double>& y) {
    for (std::size_t i = 0; i < impl_->problem.size; ++i) {
        N_VGetArrayPointer(impl_->y)[i] = y[i];
    }
    impl_->last = t;
    impl_->check(CVodeReInit(impl_->memory, t, impl_->y), t);
}

Ode::Stop Ode::advance(double t_end) { return impl_->go(t_end, CV_NORMAL); }
Ode::Stop Ode::one_step(double t_end) { return impl_->go(t_end, CV_ONE_STEP); }
const double* Ode::state() const { return N_VGetArrayPointer(impl_->y); }

long Ode::steps() const {
    long count = 0;
    CVodeGetNumSteps(impl_->memory, &count);
    return count;
}

}  // namespace underbody::dynamics
