// One case less another, on the surface of the body.
#include <vtkCellArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/text.h"
#include "postproc/field/vector_math.h"
#include "postproc/views/colours.h"
#include "postproc/views/view_composer.h"

namespace underbody::postproc {

namespace {

/// A surface to look values up on, from all body zones of a field, moved by `shift`.
class Lookup {
public:
    Lookup(const std::vector<const Zone*>& zones, const std::string& array, const Point& shift) {
        vtkNew<vtkPoints> points;
        vtkNew<vtkCellArray> cells;
        for (const Zone* zone : zones) {
            const DrawnSurface surface = drawn_surface(*zone, array);
            if (surface.values.empty()) {
                continue;
            }
            const vtkIdType first = points->GetNumberOfPoints();
            for (std::size_t i = 0; i < surface.points.size(); ++i) {
                const Point p = plus(surface.points[i], shift);
                points->InsertNextPoint(p.data());
                values_.push_back(surface.values[i]);
            }
            for (const auto& [a, b, c] : surface.triangles) {
                cells->InsertNextCell({first + a, first + b, first + c});
            }
        }
        data_->SetPoints(points);
        data_->SetPolys(cells);
        if (data_->GetNumberOfCells() > 0) {
            locator_->SetDataSet(data_);
            locator_->BuildLocator();
        }
    }

    [[nodiscard]] bool empty() const { return data_->GetNumberOfCells() == 0; }

    /// Value at the nearest place; the distance to it goes out.
    double at(const Point& p, double& distance) {
        double nearest[3];
        vtkIdType cell = -1;
        int sub = 0;
        double square = 0;
        locator_->FindClosestPoint(p.data(), nearest, cell, sub, square);
        distance = std::sqrt(square);
        vtkNew<vtkIdList> ids;
        data_->GetCellPoints(cell, ids);
        std::array<Point, 3> x{};
        for (int i = 0; i < 3; ++i) {
            data_->GetPoint(ids->GetId(i), x[static_cast<std::size_t>(i)].data());
        }
        const Point q = {nearest[0], nearest[1], nearest[2]};
        const Point normal = cross(plus(x[1], x[0], -1), plus(x[2], x[0], -1));
        const double area = dot(normal, normal);
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Point part = cross(plus(x[(i + 1) % 3], q, -1), plus(x[(i + 2) % 3], q, -1));
            const double weight = area > 0 ? dot(part, normal) / area : 1.0 / 3;
            sum += weight * values_[static_cast<std::size_t>(ids->GetId(static_cast<vtkIdType>(i)))];
        }
        return sum;
    }

private:
    vtkNew<vtkPolyData> data_;
    vtkNew<vtkStaticCellLocator> locator_;
    std::vector<double> values_;
};

/// What has to be added to the first case's pressures so that both are relative to the same, and what is said of it.
struct Level {
    double shift = 0;  ///< Pa
    std::string said;
};

Level between_references(const Field& a, const Field& b, const std::string& array) {
    using Kind = PressureReference::Kind;
    const PressureReference& of_a = a.pressure;
    const PressureReference& of_b = b.pressure;
    if (array != "pressure" || of_a.kind == Kind::unknown || of_b.kind == Kind::unknown) {
        return {};
    }
    const auto said = [](double pascal, const char* what) {
        return " " + core::format_number(pascal) + " Pa were added to the pressures of the first case, " + what + ".";
    };
    if (of_a.kind != of_b.kind) {
        const double operating = of_a.kind == Kind::gauge ? of_a.operating_pressure : of_b.operating_pressure;
        if (!(operating > 0)) {
            throw core::InputError(
                "reference",
                "one case has gauge pressures and the other absolute ones, and nothing says what lies between",
                {b.files.empty() ? "" : b.files.front(), {}, {}, {}});
        }
        const double shift = of_a.kind == Kind::gauge ? operating : -operating;
        return {shift, said(shift, "for one has gauge pressures and the other absolute ones")};
    }
    const double shift = of_a.operating_pressure - of_b.operating_pressure;
    if (of_a.kind != Kind::gauge || shift == 0 || !(of_a.operating_pressure > 0) || !(of_b.operating_pressure > 0)) {
        return {};
    }
    return {shift, said(shift, "for the operating pressures differ")};
}

/// A constant that dwarfs what changes over the body is no pressure of the flow.
std::string suspicion(const std::vector<double>& differences) {
    const auto count = static_cast<double>(differences.size());
    double mean = 0;
    double square = 0;
    for (const double d : differences) {
        mean += d / count;
    }
    for (const double d : differences) {
        square += (d - mean) * (d - mean) / count;
    }
    constexpr double half_an_atmosphere = 5e4;
    if (!(std::abs(mean) > half_an_atmosphere) || !(std::abs(mean) > 10 * std::sqrt(square))) {
        return {};
    }
    return " Note: nearly all of it is one constant, " + core::format_number(mean, 4) +
           " Pa: is one of the two an absolute pressure?";
}

/// Surfaces of the second case with the difference as their values, and what is known of it.
struct Differences {
    std::vector<DrawnSurface> surfaces;
    std::vector<double> all, on_base;
    double furthest = 0;  ///< m, between the two surfaces
    double apart = 0;     ///< m: beyond this there is nothing to compare with, another shape, not another mesh
};

/// Values of the second case less those of the first, which is moved by `shift`, and less `level`.
Differences differences(const ViewComposer& from, const ViewComposer& to, const std::string& array, const Point& shift,
                        double level, const std::string& file, const ViewOptions& options, core::Progress& progress) {
    std::vector<std::pair<std::string, std::unique_ptr<Lookup>>> lookups;
    for (const Zone* zone : from.zones()) {
        lookups.emplace_back(zone->name, std::make_unique<Lookup>(std::vector<const Zone*>{zone}, array, shift));
    }
    Lookup everywhere(from.zones(), array, shift);
    Differences result;
    result.apart = 0.02 * diagonal(to.whole_body());
    for (const Zone* zone : to.zones()) {
        progress.check();
        DrawnSurface surface = drawn_surface(*zone, array);
        // Zones of one name are compared with each other: at an edge two zones have different values at one place.
        const auto same =
            std::find_if(lookups.begin(), lookups.end(), [&](const auto& entry) { return entry.first == zone->name; });
        Lookup& lookup = same == lookups.end() ? everywhere : *same->second;
        if (surface.values.empty() || lookup.empty()) {
            throw core::InputError("missing", "'" + array + "' is not on the surface of both cases",
                                   {file, {}, {}, {}});
        }
        for (std::size_t i = 0; i < surface.points.size(); ++i) {
            double distance = 0;
            double& value = surface.values[i];
            value -= lookup.at(surface.points[i], distance) + level;
            result.furthest = std::max(result.furthest, distance);
            if (distance > result.apart) {
                value = std::nan("");
            } else if (std::isfinite(value)) {
                result.all.push_back(value);
                if (matches(options.base, zone->name)) {
                    result.on_base.push_back(value);
                }
            }
        }
        surface.contours = 12;
        mirror_into(surface, to.mirror());
        result.surfaces.push_back(std::move(surface));
    }
    return result;
}

/// Values of the base beyond the colours.
std::string extremes_of(const std::vector<double>& on_base, const std::pair<double, double>& range,
                        const std::string& unit) {
    std::string extremes;
    if (const auto [lowest, highest] = std::minmax_element(on_base.begin(), on_base.end());
        !on_base.empty() && (*lowest < range.first || *highest > range.second)) {
        extremes = " The base has from " + core::format_number(*lowest, 4) + " to " + core::format_number(*highest, 4) +
                   " " + unit + ": beyond the ends of the colours.";
    }
    return extremes;
}

std::string caption_of(const Differences& found, const Point& shift, const std::string& seen, bool vectors,
                       const std::string& rest) {
    return "The second case less the first, " + seen + "; the first was moved by (" +
           core::format_number(1000 * shift[0], 3) + ", " + core::format_number(1000 * shift[1], 3) + ", " +
           core::format_number(1000 * shift[2], 3) +
           ") mm so that the bases lie on each other; the surfaces then lie at most " +
           core::format_number(1000 * found.furthest, 2) + " mm apart" +
           (found.furthest > found.apart
                ? "; grey where that is more than " + core::format_number(1000 * found.apart, 2) +
                      " mm: nothing is compared there."
                : std::string(".")) +
           (vectors ? " The sizes of the vectors are compared, not their directions." : "") + rest;
}

/// Colours about zero, over the values of the base unless a range was asked for.
void take_colours(Scene& scene, const Differences& found, const ViewOptions& options, const std::string& unit,
                  const std::string& file) {
    const std::vector<double>& on_base = found.on_base;
    scene.colours = ColourMap::diverging;
    if (!on_base.empty()) {
        std::string cut;  // the ends below are those of the colours about zero
        scene.range = robust_colour_range(on_base, cut, unit);
    }
    for (const auto& [key, given] : options.ranges) {  // the last counts
        scene.range = given;
    }
    const auto values = range_of(scene);
    if (!(values.first <= values.second)) {
        throw core::InputError(
            "range",
            "the two bodies lie nowhere within " + core::format_number(1000 * found.apart, 2) + " mm of each other",
            {file, {}, {}, {}});
    }
    scene.range = drawn_range(values, scene.colours);
}

ComposedView composed_difference(const Field& a, const Field& b, const std::string& array, const ViewOptions& options,
                                 core::Progress& progress) {
    check_ranges(options, {"difference", "difference-" + array});
    ViewOptions named = options;
    named.case_name.clear();
    named.ranges.clear();
    const Level level = between_references(a, b, array);
    const ViewComposer from(a, named);
    const ViewComposer to(b, named);
    Point shift = plus(to.base_centre(), from.base_centre(), -1);
    if (to.mirror().axis >= 0) {  // half a base has its centre where it ends; the planes of both go onto each other
        shift[static_cast<std::size_t>(to.mirror().axis)] = to.mirror().at - from.mirror().at;
    }
    if (to.zones().empty() || from.zones().empty()) {
        const Field& bare = to.zones().empty() ? b : a;
        throw core::InputError("zone", "there is no surface of a body to compare on",
                               {bare.files.empty() ? "" : bare.files.front(), {}, {}, {}},
                               "name its zones (option 'zones')");
    }
    Differences found =
        differences(from, to, array, shift, level.shift, b.files.empty() ? "" : b.files.front(), options, progress);
    const std::vector<double>& on_base = found.on_base;
    ComposedView composed;
    composed.scene.surfaces = std::move(found.surfaces);
    Scene& scene = composed.scene;
    const auto* info = to.zones().front()->find(array);
    const std::string unit = info == nullptr ? "Pa" : info->unit;
    take_colours(scene, found, options, unit, b.files.empty() ? "" : b.files.front());
    const std::string extremes = extremes_of(on_base, *scene.range, unit);
    scene.value_name = "difference";
    scene.value_unit = unit;
    scene.camera = to.from_below();
    to.take_camera(scene);
    const bool vectors = info != nullptr && info->components > 1;
    scene.title = std::string(vectors ? "difference of the size of " : "difference of ") + view_label(array) +
                  " on the underbody";
    scene.subtitle = options.case_name.empty() ? to.case_name() + "  minus  " + from.case_name() : options.case_name;
    scene.width = options.width;
    scene.height = options.height;
    scene.text_size = options.text_size;
    const std::string seen =
        options.camera.empty() && !options.turned ? "seen from below, bow to the right" : to.camera_said();
    composed.caption =
        caption_of(found, shift, seen, vectors,
                   level.said + (view_unit(array) == unit ? suspicion(found.all) : "") + extremes + to.mirror_said());
    return composed;
}

}  // namespace

View difference_view(const Field& a, const Field& b, const std::string& array, const ViewOptions& options,
                     core::Progress& progress) {
    return drawn(composed_difference(a, b, array, options, progress), "difference-" + array);
}

std::vector<DifferenceView> difference_views(const Field& first, const std::vector<const Field*>& others,
                                             const std::string& array, const ViewOptions& options,
                                             core::Progress& progress) {
    std::vector<std::optional<ComposedView>> composed;
    std::vector<DifferenceView> views;
    double widest = 0;
    for (const Field* other : others) {
        composed.emplace_back();
        views.emplace_back();
        try {
            composed.back() = composed_difference(first, *other, array, options, progress);
            const auto range = range_of(composed.back()->scene);
            widest = std::max({widest, std::abs(range.first), std::abs(range.second)});
        } catch (const core::InputError& error) {
            views.back().why = error.message();
        }
    }
    for (std::size_t i = 0; i < composed.size(); ++i) {
        if (composed[i]) {
            progress.check();
            Scene& scene = composed[i]->scene;
            scene.range = options.ranges.empty() ? drawn_range({-widest, widest}, scene.colours) : scene.range;
            views[i].view = drawn(*composed[i], "difference-" + array);
        }
    }
    return views;
}

}  // namespace underbody::postproc
