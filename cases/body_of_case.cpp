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

const geometry::BodyShape* BodiesOfCases::shape_of(const BodySpec& body) {
    const auto [known, fresh] = shapes_.try_emplace(&body);
    if (fresh) {
        try {
            known->second = geometry::read_shape(body.shape);
        } catch (const core::Error&) {  // its own step says what is wrong with it
        }
    }
    return known->second ? &*known->second : nullptr;
}

std::optional<core::Problem> BodiesOfCases::fault(const CaseLoads& loads) {
    const Case& entry = study_.cases[loads.entry];
    const BodySpec* body = loads.values.empty() || !entry.zones.empty() ? nullptr : body_of(study_, entry);
    const geometry::BodyShape* read = body == nullptr ? nullptr : shape_of(*body);
    if (read == nullptr) {
        return {};
    }
    const geometry::BodyShape& shape = *read;
    if (geometry::tail_plate(shape) != nullptr || shape.base_offset != 0) {
        return {};  // they may reach beyond the hull
    }
    const double turned = by_pitch * std::abs(std::sin(entry.conditions.number("pitch").value_or(0)));
    const geometry::BodyShape::BaseExtent base = shape.base_extent();
    const double height = shape.base_depth() + shape.height / 2 + (shape.protrusion ? shape.protrusion->height : 0) +
                          std::max(base.nose, -base.tail) * std::tan(std::abs(shape.base_pitch));
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
    BodiesOfCases bodies(study);
    return std::none_of(results.case_loads.begin(), results.case_loads.end(), [&](const CaseLoads& loads) {
        const BodySpec* of = body_of(study, study.cases[loads.entry]);
        return of != nullptr && of->name == body && bodies.fault(loads);
    });
}

}  // namespace underbody::cases
