// The data-driven augmented linear model: states, auxiliary forces and inputs in one linear law, from moments of
// samples.
//
//     d x = A x + B u + offset,   x = (measured states; auxiliary variables), SI throughout
//
// Source: thesis chapter 7 with the corrections of docs/physics.md section 6. Frame: gap up, lift positive up, drag a
// resistance.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "surrogates/estimator/model/linear_system.h"
#include "surrogates/estimator/model/matrix.h"
#include "surrogates/estimator/model/moments.h"

namespace underbody::estimator {

/// Order of the channels of a sample: inputs, states, derivatives of the states.
struct Layout {
    std::vector<std::string> inputs;  ///< "input_force"
    std::vector<std::string> states;  ///< "heave_velocity", "gap", "ground_force", "drag_force", ...
    std::size_t measured = 2;         ///< the first states are measured, the rest auxiliary

    [[nodiscard]] std::size_t channels() const { return inputs.size() + 2 * states.size(); }
    [[nodiscard]] std::vector<std::string> names() const;  ///< derivatives as "d_NAME"
    /// heave_velocity, gap, ground_force, drag_force under input_force.
    static Layout heave();
};

enum class Fit {
    least_squares,    ///< each derivative row regressed on states and inputs with intercept (recommended)
    weighted_latent,  ///< latent regression weighted by the eigenvalues; equals least squares from the rank of C on
    method1,          ///< thesis 7.26: A = (I - W W')^# W V'
    method2,          ///< thesis 7.36: A = W S_b^#; the same matrix as method1 for every order (theorem)
};

enum class OffsetMode {
    mean,         ///< moments about the mean: the mean state gives the mean derivative exactly (default)
    none,         ///< raw second moments: no offset
    equilibrium,  ///< moments about a given point whose derivative is zero
};

struct LearnOptions {
    Fit fit = Fit::least_squares;
    std::size_t order = 0;  ///< latent variables kept; 0: the rank
    OffsetMode offset = OffsetMode::mean;
    Vector point;  ///< of OffsetMode::equilibrium: inputs then states
    /// Channels whose deviation is below this part of their size are constant and are left out.
    double constant_tolerance = 1e-12;
    /// Eigenvalues of C above this count for the rank.
    double rank_tolerance = 1e-10;
    double virtual_mass = 0;  ///< kg, to check the accelerations against; 0: unknown
};

struct AugmentedModel {
    Layout layout;
    Matrix A;       ///< states x states
    Matrix B;       ///< states x inputs
    Vector offset;  ///< one per state
    std::string method;

    // From what it was made.
    std::size_t samples = 0;
    std::size_t order = 0;
    std::size_t rank = 0;
    Vector eigenvalues;             ///< of the normalised covariance, descending, kept channels only
    Matrix basis;                   ///< T: kept channels x order, orthonormal columns
    std::vector<std::size_t> kept;  ///< channels that vary
    Vector mean, sigma;             ///< per channel; about `point` when offset mode says so
    core::Problems remarks;

    [[nodiscard]] std::size_t state(const std::string& name) const;  ///< throws core::InputError with the nearest name
    [[nodiscard]] Vector derivative(const Vector& x, const Vector& u) const;
    /// Blocks of the split (measured; auxiliary): A_x, A_zeta, J_x, J_zeta, B_u, J_u (thesis 8.3).
    [[nodiscard]] Matrix a_x() const;
    [[nodiscard]] Matrix a_zeta() const;
    [[nodiscard]] Matrix j_x() const;
    [[nodiscard]] Matrix j_zeta() const;
    [[nodiscard]] Matrix b_u() const;
    [[nodiscard]] Matrix j_u() const;
    /// Model from matrices alone (published ones).
    static AugmentedModel from_matrices(const Layout& layout, const Matrix& a, const Matrix& b,
                                        const Vector& offset = {});
};

/// Throws core::InputError: fewer samples than channels, order above the rank or above the channels, non-finite
/// moments, every channel constant. Derivatives that contradict the states are found by check_consistency and put in
/// `remarks`.
AugmentedModel learn(const Moments& moments, const Layout& layout, const LearnOptions& options = {});

/// The same model at every order from 1 to the number of kept channels; orders above the rank are marked by method
/// "refused".
std::vector<AugmentedModel> scan_orders(const Moments& moments, const Layout& layout, const LearnOptions& options = {});

/// Rows that physics fixes (kinematics): A row, B row, offset.
struct KnownRow {
    std::string state;
    Vector a;
    Vector b;
    double offset = 0;
};
/// dw = (F_g - F_d + u + bias)/S and dh = w in the given layout (total_force instead of the two forces works as well).
std::vector<KnownRow> heave_rows(const Layout& layout, double virtual_mass, double bias);
void fix_rows(AugmentedModel& model, const std::vector<KnownRow>& rows);

/// Corrections of thesis figure 8-7. p1: as fitted; p2: known rows; p3: p2 and the gap column zero; p4: p3 and every
/// structural zero.
enum class Correction { p1, p2, p3, p4 };
/// Offsets follow the means in the moments the model was made from; without such (published matrices) they stay.
AugmentedModel corrected(const AugmentedModel& model, Correction correction, const std::vector<KnownRow>& rows);

/// Error of the derivatives over a data set with these moments: root mean square of d - (A x + B u + c) per state, and
/// relative to the derivative's own deviation from its mean.
struct DerivativeError {
    Vector rms;
    Vector relative;
};
DerivativeError derivative_error(const AugmentedModel& model, const Moments& test);

/// Relations that samples must obey whatever the model: dh = w; dw linear in the forces and the input, by 1/virtual
/// mass. Returns remarks: "derivatives contradict the states" with size and the likely cause (forward differences leave
/// dt/2 in the gap row), the mass that the accelerations belong to when it is not `virtual_mass` (kg, 0: unknown), and
/// channels with a value so far from their mean that it spoils the covariance.
core::Problems check_consistency(const Moments& moments, const Layout& layout, double virtual_mass = 0);

void to_json(nlohmann::json& json, const AugmentedModel& model);
nlohmann::json matrix_json(const Matrix& matrix);

}  // namespace underbody::estimator
