#include "postproc/views/view_parts.h"

#include <vtkAppendFilter.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCutter.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkGeometryFilter.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStreamTracer.h>
#include <vtkTriangleFilter.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "postproc/field/node_values.h"
#include "postproc/field/surface_arrays.h"
#include "postproc/field/vector_math.h"
#include "postproc/loads/body_zones.h"

namespace underbody::postproc {

Box empty_box() {
    constexpr double far = std::numeric_limits<double>::infinity();
    return {far, -far, far, -far, far, -far};
}

void widen(Box& box, const Point& point) {
    for (std::size_t k = 0; k < 3; ++k) {
        box[2 * k] = std::min(box[2 * k], point[k]);
        box[2 * k + 1] = std::max(box[2 * k + 1], point[k]);
    }
}

void widen(Box& box, const Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
        box[2 * k] = std::min(box[2 * k], other[2 * k]);
        box[2 * k + 1] = std::max(box[2 * k + 1], other[2 * k + 1]);
    }
}

double diagonal(const Box& box) { return std::hypot(box[1] - box[0], box[3] - box[2], box[5] - box[4]); }

namespace {

/// As for `loads`: a pattern with * or ? means walls where it fits any; a name means whatever bears it.
std::vector<const Zone*> named_surfaces(const Field& field, const std::vector<std::string>& patterns) {
    std::vector<const Zone*> excluded_by_kind;
    const std::vector<const Zone*> walls = possible_walls(field, excluded_by_kind);
    std::vector<const Zone*> surfaces;
    std::vector<std::string> names;
    for (const auto& zone : field.zones) {
        if (zone.surface != nullptr && zone.volume == nullptr) {
            surfaces.push_back(&zone);
            names.push_back(zone.name);
        }
    }
    std::vector<bool> chosen(surfaces.size(), false);
    for (const auto& pattern : patterns) {
        const auto fits = [&](const Zone* zone) { return matches(pattern, zone->name); };
        if (std::none_of(surfaces.begin(), surfaces.end(), fits)) {
            throw core::InputError("zone", "no surface fits '" + pattern + "'",
                                   {field.files.empty() ? "" : field.files.front(), {}, {}, {}},
                                   core::did_you_mean(pattern, names));
        }
        const bool name = pattern.find_first_of("*?") == std::string::npos ||
                          std::find(names.begin(), names.end(), pattern) != names.end();
        const bool walls_alone = !name && std::any_of(walls.begin(), walls.end(), fits);
        for (std::size_t i = 0; i < surfaces.size(); ++i) {
            chosen[i] = chosen[i] || (fits(surfaces[i]) && (!walls_alone || std::find(walls.begin(), walls.end(),
                                                                                      surfaces[i]) != walls.end()));
        }
    }
    std::size_t at = 0;
    std::erase_if(surfaces, [&](const Zone*) { return !chosen[at++]; });
    return surfaces;
}

void leave_out_other_walls(std::vector<const Zone*>& zones, const std::string& base, int dimension, bool half) {
    std::vector<SurfaceArrays> surfaces;
    std::vector<WallShape> walls;
    surfaces.reserve(zones.size());
    for (const Zone* zone : zones) {
        surfaces.emplace_back(*zone->surface);
        walls.push_back(shape_of(zone->name, surfaces.back(), zone->normals_into_fluid, dimension));
        walls.back().surface = &surfaces.back();
    }
    const auto others = walls_beside_body(walls, half);
    std::erase_if(zones, [&](const Zone* zone) {
        return !matches(base, zone->name) && std::any_of(others.begin(), others.end(), [&](const LeftOutZone& other) {
            return other.name == zone->name;
        });
    });
}

}  // namespace

std::vector<const Zone*> surfaces_of_body(const Field& field, const std::vector<std::string>& patterns,
                                          const std::string& base, bool half) {
    std::vector<const Zone*> excluded_by_kind;
    std::vector<const Zone*> zones =
        patterns.empty() ? possible_walls(field, excluded_by_kind) : named_surfaces(field, patterns);
    std::erase_if(zones, [](const Zone* zone) { return zone->surface->GetNumberOfPolys() == 0; });
    if (patterns.empty() && zones.size() > 1) {
        leave_out_other_walls(zones, base, field.dimension, half);
    }
    return zones;
}

PlacedMirror mirror_of(const std::string& symmetry, const std::vector<const Zone*>& body, const Field& field,
                       core::Problems& problems) {
    std::vector<SurfaceArrays> surfaces;
    surfaces.reserve(body.size());
    std::vector<const SurfaceArrays*> all;
    for (const Zone* zone : body) {
        surfaces.emplace_back(*zone->surface);
        all.push_back(&surfaces.back());
    }
    return place_mirror(mirror_plane_from(symmetry), all, {field.files.empty() ? "" : field.files.front(), {}, {}, {}},
                        problems);
}

namespace {

double size_of(std::span<const double> values, std::size_t tuple, std::size_t components) {
    if (components == 1) {
        return values[tuple];
    }
    double square = 0;
    for (std::size_t k = 0; k < components; ++k) {
        square += values[tuple * components + k] * values[tuple * components + k];
    }
    return std::sqrt(square);
}

double face_area(const SurfaceArrays& surface, std::size_t face) {
    const auto first = surface.offsets()[face];
    const auto last = surface.offsets()[face + 1];
    const auto point = [&](Index i) {
        return surface.points().data() + 3 * surface.connectivity()[static_cast<std::size_t>(i)];
    };
    double a[3] = {0, 0, 0};
    for (Index i = first + 1; i + 1 < last; ++i) {
        const double* o = point(first);
        const double* p = point(i);
        const double* q = point(i + 1);
        const double u[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
        const double v[3] = {q[0] - o[0], q[1] - o[1], q[2] - o[2]};
        a[0] += u[1] * v[2] - u[2] * v[1];
        a[1] += u[2] * v[0] - u[0] * v[2];
        a[2] += u[0] * v[1] - u[1] * v[0];
    }
    return 0.5 * std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

std::vector<double> point_values(const Zone& zone, const SurfaceArrays& surface, const std::string& name) {
    std::vector<double> result;
    std::vector<double> own;
    if (auto* on_points = zone.surface->GetPointData()->GetArray(name.c_str())) {
        const auto values = values_of(*on_points, own);
        const auto components = static_cast<std::size_t>(on_points->GetNumberOfComponents());
        for (std::size_t i = 0; i < surface.nodes(); ++i) {
            result.push_back(size_of(values, i, components));
        }
    } else if (auto* on_faces = zone.surface->GetCellData()->GetArray(name.c_str())) {
        const auto values = values_of(*on_faces, own);
        const auto components = static_cast<std::size_t>(on_faces->GetNumberOfComponents());
        // Cell data counts verts and lines before polygons.
        const auto before =
            static_cast<std::size_t>(zone.surface->GetNumberOfVerts() + zone.surface->GetNumberOfLines());
        result.assign(surface.nodes(), 0);
        std::vector<double> weights(surface.nodes(), 0);
        for (std::size_t f = 0; f < surface.faces(); ++f) {
            const double area = face_area(surface, f);
            const double value = size_of(values, before + f, components);
            for (Index i = surface.offsets()[f]; i < surface.offsets()[f + 1]; ++i) {
                const auto node = static_cast<std::size_t>(surface.connectivity()[static_cast<std::size_t>(i)]);
                result[node] += area * value;
                weights[node] += area;
            }
        }
        for (std::size_t i = 0; i < result.size(); ++i) {
            result[i] = weights[i] > 0 ? result[i] / weights[i] : std::numeric_limits<double>::quiet_NaN();
        }
    }
    return result;
}

/// A surface cut out of another may bring all points of that, with their values.
void drop_unused_points(DrawnSurface& surface) {
    std::vector<int> place(surface.points.size(), -1);
    for (const auto& triangle : surface.triangles) {
        for (const int corner : triangle) {
            place[static_cast<std::size_t>(corner)] = 0;
        }
    }
    int kept = 0;
    for (std::size_t i = 0; i < place.size(); ++i) {
        if (place[i] < 0) {
            continue;
        }
        const auto to = static_cast<std::size_t>(kept);
        place[i] = kept++;
        surface.points[to] = surface.points[i];
        if (!surface.values.empty()) {
            surface.values[to] = surface.values[i];
        }
    }
    surface.points.resize(static_cast<std::size_t>(kept));
    surface.values.resize(surface.values.empty() ? 0 : static_cast<std::size_t>(kept));
    for (auto& triangle : surface.triangles) {
        for (int& corner : triangle) {
            corner = place[static_cast<std::size_t>(corner)];
        }
    }
}

}  // namespace

DrawnSurface drawn_surface(const Zone& zone, const std::string& array) {
    DrawnSurface drawn;
    const SurfaceArrays surface(*zone.surface);
    for (std::size_t i = 0; i < surface.nodes(); ++i) {
        const double* p = surface.points().data() + 3 * i;
        drawn.points.push_back({p[0], p[1], p[2]});
    }
    for (std::size_t f = 0; f < surface.faces(); ++f) {
        const auto first = static_cast<std::size_t>(surface.offsets()[f]);
        const auto last = static_cast<std::size_t>(surface.offsets()[f + 1]);
        for (std::size_t i = first + 1; i + 1 < last; ++i) {
            drawn.triangles.push_back({static_cast<int>(surface.connectivity()[first]),
                                       static_cast<int>(surface.connectivity()[i]),
                                       static_cast<int>(surface.connectivity()[i + 1])});
        }
    }
    if (!array.empty()) {
        drawn.values = point_values(zone, surface, array);
    }
    drop_unused_points(drawn);
    return drawn;
}

void mirror_into(DrawnSurface& surface, const PlacedMirror& mirror) {
    if (mirror.axis < 0) {
        return;
    }
    const auto k = static_cast<std::size_t>(mirror.axis);
    const auto count = static_cast<int>(surface.points.size());
    const std::size_t triangles = surface.triangles.size();
    for (int i = 0; i < count; ++i) {
        Point p = surface.points[static_cast<std::size_t>(i)];
        p[k] = 2 * mirror.at - p[k];
        surface.points.push_back(p);
    }
    for (std::size_t i = 0; i < triangles; ++i) {
        const auto [a, b, c] = surface.triangles[i];
        surface.triangles.push_back({a + count, c + count, b + count});
    }
    const std::size_t values = surface.values.size();
    for (std::size_t i = 0; i < values; ++i) {
        surface.values.push_back(surface.values[i]);
    }
}

DrawnLine mirrored(const DrawnLine& line, const PlacedMirror& mirror) {
    DrawnLine other = line;
    for (auto& p : other.points) {
        p[static_cast<std::size_t>(mirror.axis)] = 2 * mirror.at - p[static_cast<std::size_t>(mirror.axis)];
    }
    return other;
}

namespace {

/// Zones on the boundary that have one of the arrays on their faces.
std::vector<const Zone*> with_face_values(const Field& field, const std::vector<std::string>& arrays) {
    std::vector<const Zone*> zones;
    for (const auto& zone : field.zones) {
        if (zone.volume != nullptr || zone.surface == nullptr || zone.surface->GetNumberOfCells() == 0) {
            continue;
        }
        vtkPolyData& surface = *zone.surface;
        const bool faces = surface.GetNumberOfPolys() == surface.GetNumberOfCells() ||
                           (field.dimension == 2 && surface.GetNumberOfLines() == surface.GetNumberOfCells());
        if (faces && std::any_of(arrays.begin(), arrays.end(), [&](const std::string& name) {
                return surface.GetCellData()->HasArray(name.c_str()) != 0;
            })) {
            zones.push_back(&zone);
        }
    }
    return zones;
}

/// Volumes with cells: those that something flows through, else the solid ones.
std::vector<const Zone*> volumes_to_join(const Field& field) {
    std::vector<const Zone*> zones;
    for (const bool solid : {false, true}) {
        for (const auto& zone : field.zones) {
            if (zone.volume != nullptr && zone.volume->GetNumberOfCells() > 0 &&
                (zone.kind == ZoneKind::solid) == solid) {
                zones.push_back(&zone);
            }
        }
        if (!zones.empty()) {
            break;
        }
    }
    return zones;
}

const Zone* first_with(const std::vector<const Zone*>& zones, const std::string& name) {
    const auto found = std::find_if(zones.begin(), zones.end(), [&](const Zone* zone) {
        return zone->volume->GetPointData()->HasArray(name.c_str()) != 0 ||
               zone->volume->GetCellData()->HasArray(name.c_str()) != 0;
    });
    return found == zones.end() ? nullptr : *found;
}

vtkSmartPointer<vtkDoubleArray> missing_values(const std::string& name, int components, vtkIdType count) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name.c_str());
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(count);
    array->Fill(std::numeric_limits<double>::quiet_NaN());
    return array;
}

}  // namespace

vtkSmartPointer<vtkUnstructuredGrid> volume_with(const Field& field, const std::vector<std::string>& arrays) {
    const std::vector<const Zone*> zones = volumes_to_join(field);
    if (zones.empty()) {
        return nullptr;
    }
    vtkNew<vtkAppendFilter> append;
    for (const Zone* zone : zones) {
        vtkNew<vtkUnstructuredGrid> slim;
        slim->CopyStructure(zone->volume);
        for (const auto& name : arrays) {
            if (auto* on_points = zone->volume->GetPointData()->GetArray(name.c_str())) {
                slim->GetPointData()->AddArray(on_points);
            } else if (auto* on_cells = zone->volume->GetCellData()->GetArray(name.c_str())) {
                slim->GetCellData()->AddArray(on_cells);
            } else if (const Zone* like = first_with(zones, name)) {  // joining drops what one of them lacks
                const bool points = like->volume->GetPointData()->HasArray(name.c_str()) != 0;
                const vtkIdType count = points ? slim->GetNumberOfPoints() : slim->GetNumberOfCells();
                const int components = (points ? like->volume->GetPointData()->GetArray(name.c_str())
                                               : like->volume->GetCellData()->GetArray(name.c_str()))
                                           ->GetNumberOfComponents();
                (points ? static_cast<vtkDataSetAttributes*>(slim->GetPointData()) : slim->GetCellData())
                    ->AddArray(missing_values(name, components, count));
            }
        }
        append->AddInputData(slim);
    }
    append->Update();
    auto result = vtkSmartPointer<vtkUnstructuredGrid>::New();
    result->ShallowCopy(append->GetOutput());
    std::vector<std::string> in_cells;
    for (const auto& name : arrays) {
        if (result->GetPointData()->GetArray(name.c_str()) == nullptr &&
            result->GetCellData()->GetArray(name.c_str()) != nullptr) {
            in_cells.push_back(name);
        }
    }
    if (!in_cells.empty()) {
        const NodeValues carried(*result, with_face_values(field, in_cells));
        for (const auto& name : in_cells) {
            result->GetPointData()->AddArray(carried.of(name));
        }
    }
    return result;
}

namespace {

DrawnSurface flat_triangles(vtkAlgorithm& from, const std::string& array) {
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputConnection(from.GetOutputPort());
    triangles->PassLinesOff();
    triangles->PassVertsOff();
    triangles->Update();
    Zone zone;
    zone.surface = triangles->GetOutput();
    DrawnSurface drawn;
    if (zone.surface->GetNumberOfPolys() > 0) {
        drawn = drawn_surface(zone, array);
    }
    drawn.smooth = false;
    return drawn;
}

}  // namespace

DrawnSurface cut(vtkUnstructuredGrid& volume, const Point& through, const Point& normal, const std::string& array) {
    vtkNew<vtkPlane> plane;
    plane->SetOrigin(through.data());
    plane->SetNormal(normal.data());
    vtkNew<vtkCutter> cutter;
    cutter->SetInputData(&volume);
    cutter->SetCutFunction(plane);
    cutter->GenerateTrianglesOn();
    return flat_triangles(*cutter, array);
}

double lowest(vtkUnstructuredGrid& volume, const Point& up) {
    Box all{};
    volume.GetBounds(all.data());
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t corner = 0; corner < 8; ++corner) {
        least = std::min(least, dot({all[corner & 1], all[2 + ((corner >> 1) & 1)], all[4 + ((corner >> 2) & 1)]}, up));
    }
    return least;
}

DrawnSurface plane_cells(vtkUnstructuredGrid& volume, const std::string& array) {
    vtkNew<vtkGeometryFilter> cells;
    cells->SetInputData(&volume);
    return flat_triangles(*cells, array);
}

namespace {

/// The velocity without its part through the mirror plane at the plane's own nodes (averages of cells leave some
/// there).
vtkSmartPointer<vtkDataArray> velocity_along(vtkUnstructuredGrid& volume, const PlacedMirror& mirror) {
    auto* velocity = volume.GetPointData()->GetArray("velocity");
    if (velocity == nullptr || mirror.axis < 0) {
        return velocity;
    }
    auto along = vtkSmartPointer<vtkDoubleArray>::New();
    along->DeepCopy(velocity);
    along->SetName("velocity");
    const double near = 1e-6 * volume.GetLength();
    for (vtkIdType i = 0; i < volume.GetNumberOfPoints(); ++i) {
        if (std::abs(volume.GetPoint(i)[mirror.axis] - mirror.at) < near) {
            along->SetComponent(i, mirror.axis, 0);
        }
    }
    return along;
}

DrawnLine line_of(vtkPolyData& traced, vtkIdType cell) {
    auto* velocity = traced.GetPointData()->GetArray("velocity");
    vtkNew<vtkIdList> ids;
    traced.GetCellPoints(cell, ids);
    DrawnLine line;
    for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i) {
        Point p{};
        traced.GetPoint(ids->GetId(i), p.data());
        double v[3];
        velocity->GetTuple(ids->GetId(i), v);
        line.points.push_back(p);
        line.values.push_back(std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    return line;
}

}  // namespace

std::vector<DrawnLine> streamlines(vtkUnstructuredGrid& volume, const std::vector<Point>& seeds, double longest,
                                   const PlacedMirror& mirror) {
    vtkNew<vtkPoints> points;
    for (const auto& seed : seeds) {
        points->InsertNextPoint(seed.data());
    }
    vtkNew<vtkPolyData> source;
    source->SetPoints(points);
    vtkNew<vtkUnstructuredGrid> with_vectors;
    with_vectors->CopyStructure(&volume);
    with_vectors->GetPointData()->AddArray(velocity_along(volume, mirror));
    with_vectors->GetPointData()->SetActiveVectors("velocity");
    vtkNew<vtkStreamTracer> tracer;
    tracer->SetInputData(with_vectors);
    tracer->SetSourceData(source);
    tracer->SetIntegratorTypeToRungeKutta45();
    tracer->SetIntegrationDirectionToBoth();
    tracer->SetMaximumPropagation(longest);
    tracer->SetInitialIntegrationStep(0.3);
    tracer->SetMaximumNumberOfSteps(4000);
    tracer->SetTerminalSpeed(1e-5);
    tracer->SetComputeVorticity(false);
    tracer->Update();
    vtkPolyData* traced = tracer->GetOutput();
    auto* seed_of = traced->GetCellData()->GetArray("SeedIds");
    std::vector<DrawnLine> lines(seeds.size());
    if (traced->GetPointData()->GetArray("velocity") == nullptr) {
        return {};
    }
    for (vtkIdType c = 0; c < traced->GetNumberOfCells(); ++c) {
        DrawnLine half = line_of(*traced, c);
        if (half.points.size() < 2) {
            continue;
        }
        const auto seed = seed_of == nullptr ? static_cast<std::size_t>(c) % seeds.size()
                                             : static_cast<std::size_t>(seed_of->GetComponent(c, 0));
        DrawnLine& whole = lines[seed];
        if (whole.points.empty()) {
            whole = std::move(half);
            continue;
        }
        // The two halves of a line begin at its seed.
        std::reverse(whole.points.begin(), whole.points.end());
        std::reverse(whole.values.begin(), whole.values.end());
        whole.points.insert(whole.points.end(), half.points.begin() + 1, half.points.end());
        whole.values.insert(whole.values.end(), half.values.begin() + 1, half.values.end());
    }
    std::erase_if(lines, [](const DrawnLine& line) { return line.points.size() < 2; });
    return lines;
}

}  // namespace underbody::postproc
