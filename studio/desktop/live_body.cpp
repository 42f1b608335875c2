#include "studio/desktop/live_body.h"

#include <vtkCellArray.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <cmath>

#include "core/text.h"
#include "geometry/body/body_figures.h"
#include "geometry/body/body_report.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/exact_body.h"
#include "geometry/body/variants.h"

namespace underbody::studio {

namespace {

std::shared_ptr<const postproc::Field> field_of(const geometry::SurfaceMesh& mesh) {
    auto field = std::make_shared<postproc::Field>();
    for (const auto& name : mesh.patch_names) {
        const geometry::SurfaceMesh patch = geometry::patch_of(mesh, name);
        vtkNew<vtkPoints> points;
        points->SetNumberOfPoints(static_cast<vtkIdType>(patch.points.size()));
        for (std::size_t i = 0; i < patch.points.size(); ++i) {
            points->SetPoint(static_cast<vtkIdType>(i), patch.points[i].x, patch.points[i].y, patch.points[i].z);
        }
        vtkNew<vtkCellArray> cells;
        for (const auto& triangle : patch.triangles) {
            const vtkIdType corners[3] = {triangle[0], triangle[1], triangle[2]};
            cells->InsertNextCell(3, corners);
        }
        postproc::Zone zone;
        zone.name = name;
        zone.surface = vtkSmartPointer<vtkPolyData>::New();
        zone.surface->SetPoints(points);
        zone.surface->SetPolys(cells);
        field->zones.push_back(std::move(zone));
    }
    return field;
}

LiveBody body_of(const geometry::BodyShape& shape, const geometry::Placement& placement, std::size_t triangles,
                 core::Progress& progress) {
    LiveBody body;
    body.shape = shape;
    body.placement = placement;
    geometry::SurfaceOptions options;
    options.triangles = triangles;
    body.mesh = geometry::make_surface(shape, options, progress);
    body.mass = geometry::mass_properties(geometry::ExactBody(shape), body.mesh);
    body.clearance = geometry::clearance(body.mesh, placement);
    for (const auto& patch : geometry::patches(body.mesh)) {
        body.base_area += patch.name == "base" ? patch.area : 0;
    }
    body.section = geometry::section_figure(body.mesh, shape.name);
    body.drawn = Scene::prepare(field_of(body.mesh), {});
    return body;
}

}  // namespace

LiveBody moving_body(const geometry::BodyShape& shape, const geometry::Placement& placement, core::Progress& progress) {
    return body_of(shape, placement, 1500, progress);
}

LiveBody resting_body(const geometry::BodyShape& shape, const geometry::Placement& placement,
                      core::Progress& progress) {
    LiveBody body = body_of(shape, placement, 20000, progress);
    body.certificate = geometry::certify(body.mesh, shape, progress);
    return body;
}

void add_added_mass(LiveBody& body, core::Progress& progress) {
    geometry::AddedMassOptions options;
    options.placement = body.placement;
    try {
        body.added_mass = geometry::added_mass(body.shape, geometry::BodyOptions().panels, options, true, progress);
    } catch (const core::InputError& error) {
        body.contact = error.message();
    }
}

std::map<std::string, std::array<double, 2>> allowed_ranges(const geometry::BodyShape& shape,
                                                            const std::set<std::string>& parts,
                                                            core::Progress& progress) {
    std::map<std::string, std::array<double, 2>> ranges;
    for (const auto& [name, unit] : geometry::parameter_names()) {
        progress.check();
        if (unit.empty() || !parts.contains(name.substr(0, name.find('.')))) {
            continue;
        }
        double value = 0;
        try {
            value = geometry::parameter(shape, name);
        } catch (const core::Error&) {  // the part is not there: from nothing on
        }
        value = std::isfinite(value) ? value : 0;
        const auto allowed = [&, parameter = name](double number) {
            try {
                geometry::BodyShape other = shape;
                geometry::set_parameter(other, parameter, number);
                geometry::check(other);
                return true;
            } catch (const core::Error&) {
                return false;
            }
        };
        const auto end = [&](double far) {
            double in = value, out = far;
            if (allowed(far)) {
                return far;
            }
            for (int i = 0; i < 10; ++i) {  // as fine as a slider
                const double middle = 0.5 * (in + out);
                (allowed(middle) ? in : out) = middle;
            }
            return in;
        };
        const bool share = name == "body.base_cut" || name == "body.taper" || name.ends_with("position");
        const double most = unit == "rad" ? 0.35 : share ? 1 : std::max(2 * std::abs(value), 0.1 * shape.length);
        const bool both_ways = unit == "rad" || name == "body.taper" || name == "body.base_offset";
        ranges[name] = {end(both_ways ? -most : 0), end(most)};
    }
    return ranges;
}

}  // namespace underbody::studio
