// What the parts of the sweep share.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "cases/sweep.h"
#include "cases/sweep_record.h"
#include "geometry/body/body_shape.h"
#include "geometry/cases/flow_domain.h"

namespace underbody::cases {

constexpr const char* record_file = "underbody-case.json";  ///< in a case: its CaseRecord
constexpr const char* failure_file = "failure.txt";         ///< in NAME.failed: what the attempt said

/// NAME.unfinished, NAME.lock, ...
std::filesystem::path beside(const std::filesystem::path& folder, const char* ending);

geometry::FlowOptions flow_of(const Study& study, const Conditions& conditions);
/// Of a sweep without its study: density of the water (none: the usual one), half a model or a whole one.
geometry::FlowOptions flow_of(const SweepSpec& spec, std::optional<double> density, bool half,
                              const Conditions& conditions);

/// A solved case's marker; null when there is none.
nlohmann::json read_marker(const std::filesystem::path& file);
std::optional<CaseRecord> read_record(const std::filesystem::path& folder);
void write_record(const std::filesystem::path& folder, const CaseRecord& record);

/// The state now of one case whose lock the caller has; a claim of `submission` counts as its own.
void examine_again(const Study& study, SweepCase& one, const std::string& submission, core::Progress& progress);

/// Shapes and their surfaces, each made once.
class Bodies {
public:
    const geometry::BodyShape& shape(const std::filesystem::path& file);
    const geometry::SurfaceMesh& surface(const std::filesystem::path& file, core::Progress& progress);

private:
    std::map<std::filesystem::path, geometry::BodyShape> shapes_;
    std::map<std::filesystem::path, geometry::SurfaceMesh> surfaces_;
};

}  // namespace underbody::cases
