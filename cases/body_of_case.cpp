#include "cases/body_of_case.h"

#include <algorithm>
#include <cmath>

#include "core/told.h"
#include "geometry/body/body_shape.h"

namespace underbody::cases {

namespace {

constexpr double same_size = 0.03;  ///< share: coarse surfaces, edges that are rounded in one of the two
constexpr double by_pitch = 0.8;    ///< of the sine of the pitch: how far it may change the height of a flat body

/// Where it differs; empty: nowhere.
std::string difference(const char* what, double in_file, double of_shape, double allowed) {
    return std::isfinite(in_file) && std::abs(in_file - of_shape) > allowed * of_shape
               ? core::told(in_file, "m", 4) + " " + what + " in the file, " + core::told(of_shape, "m", 4) +
                     " in the shape"
               : std::string();
}

}  // namespace

const BodySpec* body_of(const Study& study, const Case& entry) {
    for (const BodySpec& body : study.bodies) {
        if (std::any_of(entry.conditions.texts.begin(), entry.conditions.texts.end(), [&](const auto& word) {
                return word.second == body.name || word.second == body.shape.stem().string();
            })) {
            return &body;
        }
    }
    return nullptr;
}

std::optional<core::Problem> body_fault(const Study& study, const CaseLoads& loads) {
    const Case& entry = study.cases[loads.entry];
    const BodySpec* body = loads.values.empty() || !entry.zones.empty() ? nullptr : body_of(study, entry);
    if (body == nullptr) {
        return {};
    }
    geometry::BodyShape shape;
    try {
        shape = geometry::read_shape(body->shape);
    } catch (const core::Error&) {
        return {};  // its own step says what is wrong with it
    }
    const double turned = by_pitch * std::abs(std::sin(entry.conditions.number("pitch").value_or(0)));
    const double height = shape.base_depth() + shape.height / 2 + (shape.protrusion ? shape.protrusion->height : 0);
    const std::string length_differs = difference("long", loads.body_length, shape.length, same_size + turned);
    const std::string height_differs = difference("high", loads.body_height, height, same_size + turned);
    if (length_differs.empty() && height_differs.empty()) {
        return {};
    }
    return core::Problem{core::Problem::Severity::warning,
                         "the body is not the shape '" + body->name + "' (" + body->shape.filename().string() +
                             "): it is " + length_differs +
                             (length_differs.empty() || height_differs.empty() ? "" : ", ") + height_differs +
                             "; the loads are of the body in the file",
                         {loads.file, {}, {}, {}}};
}

bool is_of_its_cases(const Study& study, const StudyResults& results, const std::string& body) {
    return std::none_of(results.case_loads.begin(), results.case_loads.end(), [&](const CaseLoads& loads) {
        const BodySpec* of = body_of(study, study.cases[loads.entry]);
        return of != nullptr && of->name == body && body_fault(study, loads);
    });
}

}  // namespace underbody::cases
