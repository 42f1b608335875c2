// [design] of study.toml: which numbers of a shape vary, at which conditions each design is computed, what is wanted.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cases/case_mesh.h"
#include "cases/jet_axis.h"
#include "core/file_format.h"
#include "core/toml.h"
#include "geometry/body/variants.h"
#include "surrogates/tables/search/design_search.h"

namespace underbody::cases {

/// [[design.fidelity]]: a mesh, the cheapest first.
struct FidelitySpec {
    std::string name;
    CaseMesh mesh;    ///< as in [sweep]; blocks of the density of that name, where there is one
    double cost = 1;  ///< core-seconds of a case
};

/// Something that every design is computed at.
struct ComputedCondition {
    std::string name, unit;      ///< "gap", "m"; "pitch", "rad"; "speed", "m/s"; "jet_flow" or "jet_voltage"
    std::vector<double> values;  ///< SI, ascending
    bool logarithmic = false;    ///< learned over its logarithm, where it is above zero
};

struct DesignSpec {
    std::filesystem::path shape;   ///< the file that is varied
    std::filesystem::path folder;  ///< of plan, shapes, runs and results
    std::string plan = "sobol";
    std::size_t points = 24;
    std::uint64_t seed = 1;
    std::vector<double> gaps, pitches, speeds;  ///< every design is computed at all of them; m, rad, m/s
    JetAxis jet;                                ///< and of its nozzle's jet
    double kinematic_viscosity = 1e-6;          ///< of the water, m^2/s
    std::vector<std::string> quantities;
    std::optional<double> net_weight;  ///< N, weight less buoyancy, of every design: ballast follows the volume
    double virtual_mass = 0;           ///< kg, mass + added mass in heave; 0: not stated
    std::vector<tables::SearchVariable> variables;  ///< of the shape
    std::vector<geometry::Tie> ties;                ///< [[design.tie]]
    std::vector<FidelitySpec> fidelities;           ///< at least one
    std::vector<tables::Objective> objectives;
    std::vector<tables::Limit> limits;
    double least_volume = 0, most_volume = 1e300;  ///< [design.volume], m^3: of the body, known without a run
    std::vector<core::Place> objective_places, limit_places;  ///< in study.toml

    /// Gap, pitch, speed and, with one, the jet.
    [[nodiscard]] std::vector<ComputedCondition> conditions() const;
    /// Variables of the surrogates: those of the shape, then the conditions that take several values.
    [[nodiscard]] std::vector<tables::SearchVariable> all_variables() const;
    /// Of objectives, then of limits; one that is both stands once.
    [[nodiscard]] std::vector<tables::Response> responses() const;
};

/// The SI unit of a response: a slope's is that of the quantity over that of the condition, a curve's its own.
std::string response_unit(const tables::Response& response);

/// Throws core::InputError with file and line: an unknown number of the shape, an empty range, an objective without a
/// quantity that is computed, a fidelity twice.
DesignSpec read_design(const core::TomlTable& design, const std::filesystem::path& study_folder);
/// Its objectives and limits, into `spec` that has all else.
void read_wishes(const core::TomlTable& design, DesignSpec& spec);
/// What reading does not see: conditions that a response does not state, or states in vain. Throws core::InputError
/// with the place in study.toml.
void check_responses(const DesignSpec& spec);
/// The tables of [design], for the format of study.toml.
std::vector<core::FileTable> design_tables();

/// Varied numbers of one design, equal but for the rounding of a file; the first `variables.size()` of each count.
bool same_numbers(const std::vector<tables::SearchVariable>& variables, std::span<const double> a,
                  std::span<const double> b);

/// Which of the fidelities it is. Throws core::InputError with the nearest name; `where` begins the message.
std::size_t level_of(const DesignSpec& spec, const std::string& fidelity, const std::string& where);

/// The shape at a design, its ties drawn. Throws core::InputError where there is no such shape.
geometry::BodyShape shape_at(const DesignSpec& spec, const geometry::BodyShape& base, std::span<const double> at);

/// > 0 where a limit on the geometry is broken, by how much (in units of the limit): [design.volume], or that the body
/// stands clear of the ground at every gap and pitch of [design]; 1 where there is no such shape.
double broken_by(const DesignSpec& spec, const geometry::BodyShape& base, std::span<const double> at);

}  // namespace underbody::cases
