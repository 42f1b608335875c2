#include "postproc/probe/probe.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStaticCellLocator.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/text.h"
#include "postproc/field/node_values.h"
#include "postproc/views/view_parts.h"

namespace underbody::postproc {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> known_arrays(const Field& field, bool volumes) {
    std::vector<std::string> names;
    for (const auto& zone : field.zones) {
        if ((zone.volume != nullptr) != volumes) {
            continue;
        }
        for (const auto& info : zone.arrays) {
            if (std::find(names.begin(), names.end(), info.name) == names.end()) {
                names.push_back(info.name);
            }
        }
    }
    return names;
}

/// Empty when the file does not say it.
std::string unit_of(const Field& field, const std::string& array) {
    for (const auto& zone : field.zones) {
        if (const auto* info = zone.find(array)) {
            return info->unit;
        }
    }
    return {};
}

core::Place place_of(const Field& field) { return {field.files.empty() ? "" : field.files.front(), {}, {}, {}}; }

/// The arrays asked for, checked; all when none were named.
std::vector<std::string> chosen_arrays(const Field& field, const ProbeOptions& options, bool volumes) {
    const auto known = known_arrays(field, volumes);
    if (known.empty()) {
        throw core::InputError(
            "missing", std::string("there are no values in the ") + (volumes ? "volume" : "surfaces") + " to look at",
            place_of(field), "a mesh alone has none: name the file of results");
    }
    for (const auto& name : options.arrays) {
        if (std::find(known.begin(), known.end(), name) == known.end()) {
            throw core::InputError("missing", "the field has no array '" + name + "'", place_of(field),
                                   core::did_you_mean(name, known));
        }
    }
    return options.arrays.empty() ? known : options.arrays;
}

/// Finds cells and interpolates point data, in a volume or on one surface.
class Sampler {
public:
    explicit Sampler(vtkSmartPointer<vtkPointSet> data) : data_(std::move(data)) {
        locator_->SetDataSet(data_);
        locator_->BuildLocator();
        weights_.resize(static_cast<std::size_t>(std::max(8, data_->GetMaxCellSize())));
    }

    /// Points and weights of the cell that holds `p`; false outside.
    bool inside(const Point& p) {
        double pcoords[3];
        Point at = p;
        const vtkIdType cell = locator_->FindCell(at.data(), 1e-12, cell_, pcoords, weights_.data());
        if (cell < 0) {
            return false;
        }
        data_->GetCellPoints(cell, ids_);
        return true;
    }

    /// The same for the nearest face; returns its distance.
    double nearest(const Point& p) {
        double closest[3];
        vtkIdType cell = -1;
        int sub = 0;
        double square = 0;
        Point at = p;
        locator_->FindClosestPoint(at.data(), closest, cell_, cell, sub, square);
        double pcoords[3];
        double ignored = 0;
        data_->GetCell(cell, cell_);
        double again[3];
        cell_->EvaluatePosition(closest, again, sub, pcoords, ignored, weights_.data());
        data_->GetCellPoints(cell, ids_);
        return std::sqrt(square);
    }

    [[nodiscard]] vtkDataArray* array(const std::string& name) const {
        return data_->GetPointData()->GetArray(name.c_str());
    }

    double value(vtkDataArray& array, int component) const {
        double sum = 0;
        for (vtkIdType i = 0; i < ids_->GetNumberOfIds(); ++i) {
            sum += weights_[static_cast<std::size_t>(i)] * array.GetComponent(ids_->GetId(i), component);
        }
        return sum;
    }

private:
    vtkSmartPointer<vtkPointSet> data_;
    vtkNew<vtkStaticCellLocator> locator_;
    vtkNew<vtkGenericCell> cell_;
    vtkNew<vtkIdList> ids_;
    std::vector<double> weights_;
};

/// One surface with its values at the nodes.
vtkSmartPointer<vtkPolyData> surface_with_point_values(const Zone& zone, const std::vector<std::string>& arrays) {
    auto result = vtkSmartPointer<vtkPolyData>::New();
    result->SetPoints(zone.surface->GetPoints());
    result->SetPolys(zone.surface->GetPolys());
    std::unique_ptr<NodeValues> carried;
    const bool only_polygons = zone.surface->GetNumberOfPolys() == zone.surface->GetNumberOfCells();
    for (const auto& name : arrays) {
        if (auto* on_points = zone.surface->GetPointData()->GetArray(name.c_str())) {
            result->GetPointData()->AddArray(on_points);
        } else if (only_polygons && zone.surface->GetCellData()->GetArray(name.c_str()) != nullptr) {
            carried = carried == nullptr ? std::make_unique<NodeValues>(*zone.surface) : std::move(carried);
            result->GetPointData()->AddArray(carried->of(name));
        }
    }
    return result;
}

/// Columns in the making.
struct Columns {
    std::vector<std::string> names;
    std::vector<std::string> units;
    std::vector<std::vector<double>> values;

    std::size_t add(const std::string& name, const std::string& unit, std::size_t rows) {
        names.push_back(name);
        units.push_back(unit);
        values.emplace_back(rows, nan);
        return values.size() - 1;
    }
    [[nodiscard]] core::Table table() const {
        core::Table result;
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (!units[i].empty()) {
                result.add_numbers(names[i], units[i], values[i]);
                continue;
            }
            std::vector<std::string> numbers;  // of a unit that nobody knows: a column of numbers has one
            for (const double value : values[i]) {
                numbers.push_back(std::isfinite(value) ? core::format_number(value) : "");
            }
            result.add_text(names[i], std::move(numbers));
        }
        return result;
    }
};

struct ArrayColumns {
    std::string array;
    std::size_t first = 0;
    int components = 1;
};

std::vector<ArrayColumns> columns_for(const Field& field, const std::vector<std::string>& arrays, std::size_t rows,
                                      Columns& columns) {
    std::vector<ArrayColumns> result;
    for (const auto& array : arrays) {
        int components = 1;
        for (const auto& zone : field.zones) {
            if (const auto* info = zone.find(array)) {
                components = std::max(components, info->components);
            }
        }
        ArrayColumns entry{array, columns.values.size(), components};
        for (int k = 0; k < components; ++k) {
            const std::string suffix = components == 1   ? ""
                                       : components <= 3 ? std::string("_") + "xyz"[k]
                                                         : "_" + std::to_string(k);
            columns.add(array + suffix, unit_of(field, array), rows);
        }
        result.push_back(entry);
    }
    return result;
}

void fill_row(const Sampler& sampler, const std::vector<ArrayColumns>& arrays, std::size_t row, Columns& columns) {
    for (const auto& entry : arrays) {
        if (auto* array = sampler.array(entry.array)) {
            for (int k = 0; k < std::min(entry.components, array->GetNumberOfComponents()); ++k) {
                columns.values[entry.first + static_cast<std::size_t>(k)][row] = sampler.value(*array, k);
            }
        }
    }
}

void probe_volume(const Field& field, const std::vector<Point>& points, const std::vector<std::string>& arrays,
                  Columns& columns, core::Progress& progress) {
    const auto entries = columns_for(field, arrays, points.size(), columns);
    Sampler sampler(volume_with(field, arrays));
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % 256 == 0) {
            progress.check();
        }
        if (sampler.inside(points[i])) {
            fill_row(sampler, entries, i, columns);
        }
    }
}

std::vector<const Zone*> surfaces_to_look_on(const Field& field, const std::vector<std::string>& patterns) {
    std::vector<const Zone*> zones;
    std::vector<std::string> names;
    for (const auto& zone : field.zones) {
        if (zone.surface != nullptr && zone.volume == nullptr && zone.surface->GetNumberOfPolys() > 0) {
            names.push_back(zone.name);
            if (matches_any(patterns, zone.name)) {
                zones.push_back(&zone);
            }
        }
    }
    for (const auto& pattern : patterns) {
        if (std::none_of(names.begin(), names.end(), [&](const std::string& name) { return matches(pattern, name); })) {
            throw core::InputError("zone", "no surface with faces fits '" + pattern + "'", place_of(field),
                                   core::did_you_mean(pattern, names));
        }
    }
    if (zones.empty()) {
        throw core::InputError("zone", "there is no surface to look on", place_of(field));
    }
    return zones;
}

void probe_surfaces(const Field& field, const std::vector<Point>& points, const std::vector<std::string>& arrays,
                    const ProbeOptions& options, Columns& columns, core::Progress& progress) {
    const std::size_t distances = columns.add("distance_to_surface", "m", points.size());
    const auto entries = columns_for(field, arrays, points.size(), columns);
    std::vector<std::unique_ptr<Sampler>> samplers;
    for (const Zone* zone : surfaces_to_look_on(field, options.zones)) {
        samplers.push_back(std::make_unique<Sampler>(surface_with_point_values(*zone, arrays)));
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        progress.check();
        // All values of a row are those of one zone: what that lacks is missing.
        const Sampler* nearest = nullptr;
        double best = std::numeric_limits<double>::infinity();
        for (const auto& sampler : samplers) {
            const double distance = sampler->nearest(points[i]);
            if (distance < best) {
                best = distance;
                nearest = sampler.get();
            }
        }
        if (nearest != nullptr) {
            fill_row(*nearest, entries, i, columns);
            columns.values[distances][i] = best;
        }
    }
}

}  // namespace

core::Table probe_points(const Field& field, const std::vector<Point>& points, const ProbeOptions& options,
                         core::Progress& progress) {
    if (points.empty()) {
        throw core::UsageError("usage", "no points to look at");
    }
    Columns columns;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t at = columns.add(std::string(1, "xyz"[k]), "m", points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            columns.values[at][i] = points[i][k];
        }
    }
    const bool volumes = !options.on_surface && std::any_of(field.zones.begin(), field.zones.end(), [](const Zone& z) {
        return z.volume != nullptr && z.volume->GetNumberOfCells() > 0;
    });
    if (volumes && !options.zones.empty()) {
        throw core::UsageError("usage", "zones choose surfaces, but it is the volume that is looked into", {},
                               "option 'on-surface' looks on surfaces, or leave option 'zones' away");
    }
    const auto arrays = chosen_arrays(field, options, volumes);
    if (volumes) {
        probe_volume(field, points, arrays, columns, progress);
    } else {
        probe_surfaces(field, points, arrays, options, columns, progress);
    }
    return columns.table();
}

core::Table probe_line(const Field& field, const Point& from, const Point& to, int count, const ProbeOptions& options,
                       core::Progress& progress) {
    if (count < 2) {
        throw core::UsageError("usage", "a line has two points at least");
    }
    std::vector<Point> points;
    std::vector<double> distances;
    const double length = std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    for (int i = 0; i < count; ++i) {
        const double t = static_cast<double>(i) / (count - 1);
        points.push_back(
            {from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]), from[2] + t * (to[2] - from[2])});
        distances.push_back(t * length);
    }
    core::Table table = probe_points(field, points, options, progress);
    table.add_numbers("distance", "m", std::move(distances));
    return table;
}

core::Table probe_plane(const Field& field, const Point& origin, const Point& across, const Point& along, int columns,
                        int rows, const ProbeOptions& options, core::Progress& progress) {
    if (columns < 2 || rows < 2) {
        throw core::UsageError("usage", "a plane has two points at least each way");
    }
    std::vector<Point> points;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            Point p = origin;
            for (std::size_t k = 0; k < 3; ++k) {
                p[k] += across[k] * i / (columns - 1) + along[k] * j / (rows - 1);
            }
            points.push_back(p);
        }
    }
    return probe_points(field, points, options, progress);
}

}  // namespace underbody::postproc
