#include "surrogates/estimator/control/theory.h"

#include <cmath>

#include "core/error.h"
#include "surrogates/estimator/control/bounds.h"
#include "surrogates/estimator/observe/observer.h"

namespace underbody::estimator {

namespace {

using core::ClosedForm;
using Result = ClosedForm::Result;
using Values = ClosedForm::Values;

constexpr std::nullopt_t needed = std::nullopt;

Matrix two_by_two(const Values& v, const std::string& name) {
    return Matrix{{v(name + "11"), v(name + "12")}, {v(name + "21"), v(name + "22")}};
}

Result margins(const Values& v) {
    const Matrix a = two_by_two(v, "a");
    const RobustnessBounds r = robustness_bounds(a, two_by_two(v, "change"));
    const Poles poles = eigenvalues(a);
    const bool real = poles[0].imag() == 0;
    return {{{"eigenvalue_1", "1/s", poles[0].real(), real ? "" : "real part"},
             {"eigenvalue_2", "1/s", poles[1].real(), real ? "" : "real part"},
             {"eigenvalue_imaginary", "1/s", std::abs(poles[0].imag()), "of both"},
             {"stability_degree", "1/s", r.stability_degree, "the least distance of an eigenvalue from instability"},
             {"p11", "s", r.hurwitz ? r.p(0, 0) : NAN, "of the P that solves P A + A' P + 2 I = 0"},
             {"p12", "s", r.hurwitz ? r.p(0, 1) : NAN, ""},
             {"p22", "s", r.hurwitz ? r.p(1, 1) : NAN, ""},
             {"norm", "1/s", r.patel_toda, "a change of no larger spectral norm is borne (Patel and Toda)"},
             {"each_entry", "1/s", r.patel_toda_element, "likewise a change of no larger entries: norm / 2"},
             {"each_changing_entry", "1/s", r.yedavalli,
              "likewise of those entries that may change (Yedavalli), sharper where few may"}},
            {{"the matrix is stable as it is", r.hurwitz}}};
}

/// heave_velocity, gap, ground_force, drag_force: the known rows, and the rows of the forces as given.
AugmentedModel model_of(const Values& v) {
    const double inverse = 1 / v("virtual_mass");
    const Matrix jx = two_by_two(v, "jx"), j = two_by_two(v, "j");
    Matrix a(4, 4), b(4, 1);
    a(0, 2) = inverse;
    a(0, 3) = -inverse;
    a(1, 0) = 1;
    b(0, 0) = inverse;
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t k = 0; k < 2; ++k) {
            a(2 + i, k) = jx(i, k);
            a(2 + i, 2 + k) = j(i, k);
        }
    }
    return AugmentedModel::from_matrices(Layout::heave(), a, b);
}

Result two_forces(const Values& v) {
    if (!(v("virtual_mass") > 0)) {
        throw core::UsageError("range", "the virtual mass must be positive");
    }
    const AugmentedModel model = model_of(v);
    const Matrix j = model.j_zeta();
    const Separability told = separability(model);
    const Poles poles = eigenvalues(j);
    double l1 = NAN, l2 = NAN;
    if (told.reduced.rank == 2) {
        const Matrix gain = reduced_gain(model, {v("pole_1"), v("pole_2")});
        l1 = gain(0, 0);
        l2 = gain(1, 0);
    }
    const double used1 = std::isfinite(l1) ? l1 : v("gain_1"), used2 = std::isfinite(l2) ? l2 : v("gain_2");
    const Matrix error = exponential(
        v("time") * (j - Matrix{{used1}, {used2}} * Matrix{{1 / v("virtual_mass"), -1 / v("virtual_mass")}}));
    const Vector left = error * Vector{v("ground_error"), v("drag_error")};
    const SteadyState rest = steady_state(model.j_x(), j, {v("heave_velocity"), v("gap")});
    return {{{"eigenvalue_1", "1/s", poles[0].real(), "of the forces' own matrix, real part"},
             {"eigenvalue_2", "1/s", poles[1].real(), ""},
             {"observability", "1/s", j(0, 0) + j(0, 1) - j(1, 0) - j(1, 1),
              "j11 + j12 - j21 - j22: 0 where the two forces cannot be told apart"},
             {"rank", "1", static_cast<double>(told.reduced.rank), "of two forces seen through gap and heave velocity"},
             {"full_rank", "1", static_cast<double>(told.full.rank), "of all four states"},
             {"gain_1", "N s/m", l1, "of the observer with these poles, on the innovation of the velocity"},
             {"gain_2", "N s/m", l2, ""},
             {"drag_slope", "N s/m", told.b_eff, "the drag law that the model holds at slow drift, J_x21/-(j21 + j22)"},
             {"steady_ground_force", "N", rest.converges ? rest.limit[0] : NAN,
              "where the estimates go at this gap and velocity without innovation"},
             {"steady_drag_force", "N", rest.converges ? rest.limit[1] : NAN, ""},
             {"ground_error_left", "N", left[0], "of the errors given, after the time"},
             {"drag_error_left", "N", left[1], ""}},
            {{"the two forces are seen apart: rank 2; else the gains given count", told.reduced.rank == 2},
             {"the forces' own matrix is stable: the estimates go somewhere", rest.converges}}};
}

std::vector<ClosedForm> made() {
    std::vector<ClosedForm::Input> of_forces = {
        {"j11", "1/s", "how the rate of the ground force depends on the ground force ...", needed},
        {"j12", "1/s", "... on the drag", needed},
        {"j21", "1/s", "how the rate of the drag depends on the ground force ...", needed},
        {"j22", "1/s", "... on the drag", needed},
        {"jx11", "N/m", "rate of the ground force over the heave velocity", 0.0},
        {"jx12", "N/m/s", "... over the gap", 0.0},
        {"jx21", "N/m", "rate of the drag over the heave velocity", 0.0},
        {"jx22", "N/m/s", "... over the gap", 0.0},
        {"virtual_mass", "kg", "mass and added mass in heave", needed},
        {"pole_1", "1/s", "wanted of the observer's error", -1.0},
        {"pole_2", "1/s", "", -2.0},
        {"gain_1", "N s/m", "of an observer of one's own, where the poles cannot be placed", 0.0},
        {"gain_2", "N s/m", "", 0.0},
        {"heave_velocity", "m/s", "held", 0.0},
        {"gap", "m", "held", 0.0},
        {"ground_error", "N", "of the estimates at the start", 0.0},
        {"drag_error", "N", "", 0.0},
        {"time", "s", "later", 0.0}};
    return {{"margins",
             "How much a 2 x 2 matrix may change and stay stable",
             "P A + A' P + 2 I = 0; |E| < 1/sigma_max(P); |e_ij| < 1/sigma_max((|P| U)_s)",
             "Patel and Toda 1980; Yedavalli 1985",
             {{"a11", "1/s", "", needed},
              {"a12", "1/s", "", needed},
              {"a21", "1/s", "", needed},
              {"a22", "1/s", "", needed},
              {"change11", "1", "1: this entry may change, 0: it may not", 1.0},
              {"change12", "1", "", 1.0},
              {"change21", "1", "", 1.0},
              {"change22", "1", "", 1.0}},
             margins},
            {"two_forces", "Ground force and drag apart, out of gap and heave velocity, by a linear model of both",
             "d(F_g, F_d)/dt = J_x (w, h) + J (F_g, F_d), dw/dt = (F_g - F_d)/S", "docs/physics.md section 7",
             std::move(of_forces), two_forces}};
}

}  // namespace

const std::vector<core::ClosedForm>& closed_forms() {
    static const std::vector<core::ClosedForm> all = made();
    return all;
}

}  // namespace underbody::estimator
