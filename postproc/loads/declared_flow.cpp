// The point of the moments and the speed that were declared of a case against the body and the pressures in its file.
#include <vtkCellData.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/quantile.h"
#include "core/text.h"
#include "core/water.h"
#include "postproc/field/field.h"
#include "postproc/field/surface_arrays.h"
#include "postproc/loads/declared.h"

namespace underbody::postproc {

namespace {

using core::Problem;

/// m, file axes: half the size of the box about the body, and its middle. A half model's is widened over its plane.
struct BodyBox {
    Vector middle{}, half{};
};

std::optional<BodyBox> box_of_body(const Field& field, const LoadsResult& loads) {
    Vector lower{HUGE_VAL, HUGE_VAL, HUGE_VAL}, upper{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (const auto& summed : loads.zones) {
        const Zone* zone = field.find(summed.name);
        if (zone == nullptr || !zone->surface || zone->surface->GetNumberOfPoints() == 0) {
            continue;
        }
        std::array<double, 6> b{};
        zone->surface->GetBounds(b.data());
        for (std::size_t k = 0; k < 3; ++k) {
            lower[k] = std::min(lower[k], b[2 * k]);
            upper[k] = std::max(upper[k], b[2 * k + 1]);
        }
    }
    if (!(lower[0] <= upper[0])) {
        return {};
    }
    BodyBox box;
    for (std::size_t k = 0; k < 3; ++k) {
        box.middle[k] = 0.5 * (lower[k] + upper[k]);
        box.half[k] = (static_cast<int>(k) == loads.mirror_axis ? 1.5 : 0.5) * (upper[k] - lower[k]);
    }
    return box;
}

double distance_to(const BodyBox& box, const Vector& point) {
    Vector outside{};
    for (std::size_t k = 0; k < 3; ++k) {
        outside[k] = std::max(0.0, std::abs(point[k] - box.middle[k]) - box.half[k]);
    }
    return norm(outside);
}

/// Pressures with the heights (m, along up) at which they are; a part of them where there are many.
struct WallPressures {
    std::vector<double> values, heights;
};

void add_pressures(const Zone& zone, const Vector& up, double density, WallPressures& all) {
    constexpr std::size_t enough = 20000;
    for (const char* name : {"pressure", "kinematic_pressure", "pressure_absolute"}) {
        vtkDataArray* on_faces = zone.surface->GetCellData()->GetArray(name);
        vtkDataArray* array = on_faces != nullptr ? on_faces : zone.surface->GetPointData()->GetArray(name);
        if (array == nullptr || array->GetNumberOfComponents() != 1) {
            continue;
        }
        const double scale = std::string_view(name) == "kinematic_pressure" ? density : 1;
        std::vector<double> own;
        const SurfaceArrays surface(*zone.surface);
        const auto values = values_of(*array, own);
        const std::size_t count = std::min(values.size(), on_faces != nullptr ? surface.faces() : surface.nodes());
        const std::size_t stride = std::max<std::size_t>(1, count / enough);
        for (std::size_t i = 0; i < count; i += stride) {
            const auto first = on_faces != nullptr ? static_cast<std::size_t>(surface.offsets()[i]) : 0;
            const auto node = on_faces != nullptr ? static_cast<std::size_t>(surface.connectivity()[first]) : i;
            const double* x = surface.points().data() + 3 * node;
            all.values.push_back(scale * values[i]);
            all.heights.push_back(dot({x[0], x[1], x[2]}, up));
        }
        return;
    }
}

/// Of the zones that were summed, but those that fit `without`.
WallPressures pressures_of(const Field& field, const LoadsResult& loads, const std::string& without) {
    WallPressures all;
    for (const auto& summed : loads.zones) {
        const Zone* zone = field.find(summed.name);
        if (zone != nullptr && zone->surface && !matches(without, summed.name)) {
            add_pressures(*zone, loads.up, loads.coefficients->density, all);
        }
    }
    return all;
}

/// Pa: from the middle of the values to the highest.
double above_the_middle(const std::vector<double>& values) {
    return *std::max_element(values.begin(), values.end()) - core::median(values);
}

/// What to ask of pressures that are `ratio` times those that belong to the speed.
std::string likely_flow_unit(double ratio) {
    struct Mistake {
        double ratio;
        const char* question;
    };
    constexpr double hour = 3.6;  // km/h, of a m/s
    constexpr std::array mistakes = {
        Mistake{1000, "is the pressure in Pa, and was read in kPa?"},
        Mistake{1e-3, "is the pressure in kPa, or over density, and was read in Pa?"},
        Mistake{1e6, "is the speed in m/s, and was read in mm/s?"},
        Mistake{1e-6, "is the speed in mm/s, and was read in m/s?"},
        Mistake{1e4, "is the speed in m/s, and was read in cm/s?"},
        Mistake{1e-4, "is the speed in cm/s, and was read in m/s?"},
        Mistake{hour * hour, "is the speed in m/s, and was read in km/h?"},
        Mistake{1 / hour / hour, "is the speed in km/h, and was read in m/s?"},
    };
    constexpr double slack = 1.6;
    for (const auto& [factor, question] : mistakes) {
        if (ratio < factor * slack && ratio > factor / slack) {
            return question;
        }
    }
    return "are their units right, and the file the one that was meant?";
}

}  // namespace

std::optional<Problem> reference_fault(const Field& field, const LoadsResult& loads, double limit) {
    const auto box = loads.reference_from == "given" ? box_of_body(field, loads) : std::nullopt;
    const double length = box ? 2 * std::max({box->half[0], box->half[1], box->half[2]}) : 0;
    const double distance = box ? distance_to(*box, loads.reference) : 0;
    if (!(length > 0) || !(distance > limit * length)) {
        return {};
    }
    const auto number = [](double value) { return core::format_number(value, 4); };
    const Vector& r = loads.reference;
    std::string question = "is it the point that was meant, in the file's axes?";
    for (const auto& [unit, name] : {std::pair{1e-3, "mm"}, std::pair{1e-2, "cm"}, std::pair{0.0254, "in"}}) {
        if (distance_to(*box, {unit * r[0], unit * r[1], unit * r[2]}) < 0.5 * length) {
            question = std::string("is it in ") + name + ", and was read in m?";
            break;
        }
    }
    return Problem{Problem::Severity::warning,
                   "the moments are taken about (" + number(r[0]) + ", " + number(r[1]) + ", " + number(r[2]) +
                       ") m, " + core::format_number(distance / length, 2) +
                       " lengths of the body away from it: " + question,
                   {loads.file, {}, {}, {}}};
}

std::optional<Problem> flow_fault(const Field& field, const LoadsResult& loads, const std::string& base) {
    if (!loads.coefficients || loads.closure > nearly_closed_within) {
        return {};
    }
    const double density = loads.coefficients->density, speed = loads.coefficients->speed;
    WallPressures wall = pressures_of(field, loads, base);
    const bool apart = !wall.values.empty();
    if (!apart) {
        wall = pressures_of(field, loads, "");
    }
    constexpr std::size_t few = 20;
    if (wall.values.size() < few) {
        return {};
    }
    double highest = above_the_middle(wall.values);
    for (std::size_t i = 0; i < wall.values.size(); ++i) {
        wall.values[i] += density * core::standard_gravity * wall.heights[i];
    }
    highest = std::min(highest, above_the_middle(wall.values));  // the weight of the water, where the file has it
    // Round bodies over a moving ground have 1.4 to 1.5; a film under the base may push harder.
    constexpr double usual = 1.45, low = 0.2, high = 6, high_with_base = 30;
    const double stagnation = 0.5 * density * speed * speed;
    if (highest >= low * stagnation && highest <= (apart ? high : high_with_base) * stagnation) {
        return {};
    }
    return Problem{Problem::Severity::warning,
                   "the highest pressure on the body lies " + core::format_number(highest, 4) +
                       " Pa over the middle one, but a flow of " + core::format_number(speed, 4) +
                       " m/s comes to rest at 1/2 rho U^2 = " + core::format_number(stagnation, 4) +
                       " Pa; such pressures are of about " +
                       core::format_number(std::sqrt(2 * highest / usual / density), 2) +
                       " m/s: " + likely_flow_unit(highest / usual / stagnation),
                   {loads.file, {}, {}, {}}};
}

core::Problems declared_faults(const Field& field, const LoadsResult& loads, const Declared& said) {
    constexpr double far = 3, far_of_some_zones = 30;  // zones that were named may be a part of the body
    core::Problems all;
    for (const auto& fault : {gap_fault(field, loads, said.gap, said.pitch), pitch_fault(loads, said.base, said.pitch),
                              reference_fault(field, loads, said.zones_named ? far_of_some_zones : far),
                              said.driven ? std::nullopt : flow_fault(field, loads, said.base)}) {
        if (fault) {
            all.push_back(*fault);
        }
    }
    return all;
}

}  // namespace underbody::postproc
