// How far a computed load can be trusted: mesh and iteration.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace underbody::postproc {

/// A value on one mesh. Only ratios of sizes matter.
struct MeshValue {
    double size = 0;  ///< representative cell size
    double value = 0;
};

/// Size of a mesh with so many cells over the same domain: cells^(-1/dimension).
double mesh_size(double cells, int dimension = 3);

enum class MeshVerdict {
    same,         ///< all values agree to rounding
    assumed,      ///< two meshes: the order was assumed, not observed
    monotone,     ///< differences shrink with the mesh
    oscillating,  ///< differences change sign and shrink
    diverging,    ///< differences grow as the mesh gets finer
};
std::string to_string(MeshVerdict verdict);

/// Values of one quantity over two meshes or more.
///
/// Three meshes: Celik, Ghia, Roache, Freitas, Coleman, Raad (J. Fluids Eng. 130, 078001, 2008), safety factor 1.25,
/// orders above `formal_order` are not believed in the GCI: then that order is used, and the difference of the coarser
/// pair where it makes the larger error (two meshes that agree by luck are no proof). Two: Roache's factor 3 at the
/// formal order. More than three: least squares after Eça and Hoekstra (J. Comput. Phys. 262, 2014, section 3), on all
/// meshes: an order that is not plausible gives way to a fit with the first and the formal one, with factor 3.
/// Oscillating: the half range of the values is the interval (Stern et al. 2001); diverging: their whole range. Both
/// are taken as evenly distributed. (Of more than three meshes these are words only: the fit's scatter says it.)
struct MeshUncertainty {
    MeshVerdict verdict = MeshVerdict::same;
    double value = 0;             ///< on the finest mesh
    double observed_order = 0;    ///< NaN when none can be had
    double used_order = 0;        ///< what the index was computed with; NaN for none, or two orders together
    double extrapolated = 0;      ///< value at size zero; the finest value when there is no order
    double relative_change = 0;   ///< |finest - next| / |finest|
    double gci_fine = 0;          ///< relative, between the finest two meshes (or the interval over |value|)
    double gci_coarse = 0;        ///< between the second and third; NaN for two meshes
    double asymptotic_ratio = 0;  ///< gci_coarse / (r21^p gci_fine): 1 in the asymptotic range; NaN when there is none
    double expanded_uncertainty = 0;  ///< absolute, about 95 %
    double standard_uncertainty = 0;  ///< absolute, one standard deviation
    std::size_t meshes = 0;
    std::string text;  ///< one sentence for people
};

/// `values` in any order; values that differ by no more than `nothing` are the same (what symmetry makes nought leaves
/// rounding behind). Throws core::InputError: fewer than two meshes, equal sizes, values that are not finite.
MeshUncertainty mesh_uncertainty(std::span<const MeshValue> values, double formal_order = 2, double nothing = 0);

/// What the end of a monitor says.
struct IterationScatter {
    std::size_t first = 0;  ///< where the settled tail begins (marginal standard error rule, White 1997)
    std::size_t count = 0;  ///< its length
    double mean = 0;
    double deviation = 0;         ///< one standard deviation of the values: of the last one as the result
    double error_of_mean = 0;     ///< one standard deviation of the mean, of as many values as are independent
    double correlation_time = 1;  ///< values that count as one independent value (see correlation_time)
    double drift = 0;             ///< change over the tail by its straight line
    double period = 0;            ///< iterations of the strongest cycle; 0 when there is none
    bool settled = true;  ///< the drift may be chance (2.5 standard deviations), or is below half the scatter, or
                          ///< both are below 1e-3 of the mean
    double standard_uncertainty = 0;  ///< deviation and drift together
    std::string text;
};

/// How many values of a history count as one independent value: 1 + 2 sum of its autocorrelation, over pairs of lags as
/// long as these are positive (Geyer 1992, initial positive sequence), at least 1 and at most all of them. `values`:
/// two or more.
double correlation_time(std::span<const double> values);

/// The mean of what fluctuates, and how well it is known.
struct MeanInTime {
    double mean = 0;
    double deviation = 0;         ///< one standard deviation of the values
    double error = 0;             ///< one of the mean: deviation / sqrt(effective)
    double correlation_time = 1;  ///< in values
    double effective = 0;         ///< independent values: their number over the correlation time
};
/// Throws core::InputError: fewer than two values, or not finite.
MeanInTime mean_in_time(std::span<const double> values);

constexpr std::size_t shortest_history = 8;  ///< values that iteration_scatter needs

/// `history`: one value an iteration (or a time step). Throws core::InputError: too short, or not finite.
IterationScatter iteration_scatter(std::span<const double> history);

/// Mesh, iteration and any other independent parts together.
double combined(std::span<const double> standard_uncertainties);

void to_json(nlohmann::json& json, const MeshUncertainty& result);
void to_json(nlohmann::json& json, const IterationScatter& result);

}  // namespace underbody::postproc
