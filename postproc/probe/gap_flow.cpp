// What flows through the gap under the base.
#include <vtkCellData.h>
#include <vtkCutter.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPointData.h>
#include <vtkTriangleFilter.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/text.h"
#include "postproc/field/surface_arrays.h"
#include "postproc/field/vector_math.h"
#include "postproc/loads/mirror_plane.h"
#include "postproc/loads/vehicle_axes.h"
#include "postproc/probe/probe.h"
#include "postproc/views/view_parts.h"

namespace underbody::postproc {

namespace {

core::Place place_of(const Field& field) { return {field.files.empty() ? "" : field.files.front(), {}, {}, {}}; }

/// A corner of a section in its own plane: to starboard, up, with what is integrated.
struct Corner {
    double side, height, velocity, speed, pressure;
};

Corner between(const Corner& a, const Corner& b, double t) {
    const auto mix = [t](double x, double y) { return x + t * (y - x); };
    return {mix(a.side, b.side), mix(a.height, b.height), mix(a.velocity, b.velocity), mix(a.speed, b.speed),
            mix(a.pressure, b.pressure)};
}

/// Keeps the part of a polygon where sign * (coordinate - limit) <= 0 (Sutherland and Hodgman 1974).
std::vector<Corner> clipped(const std::vector<Corner>& polygon, double Corner::*coordinate, double limit, double sign) {
    std::vector<Corner> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner& a = polygon[i];
        const Corner& b = polygon[(i + 1) % polygon.size()];
        const double da = sign * (a.*coordinate - limit);
        const double db = sign * (b.*coordinate - limit);
        if (da <= 0) {
            kept.push_back(a);
        }
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            kept.push_back(between(a, b, da / (da - db)));
        }
    }
    return kept;
}

struct Sums {
    double area = 0, flow = 0, speed = 0, pressure = 0, flow_pressure = 0;

    /// Linear over each triangle of the fan: exact for sums, and for the product of two by the rule of the midpoints.
    void add(const std::vector<Corner>& polygon) {
        for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
            const std::array<Corner, 3> c = {polygon[0], polygon[i], polygon[i + 1]};
            const double a = 0.5 * std::abs((c[1].side - c[0].side) * (c[2].height - c[0].height) -
                                            (c[2].side - c[0].side) * (c[1].height - c[0].height));
            area += a;
            for (std::size_t k = 0; k < 3; ++k) {
                const Corner middle = between(c[k], c[(k + 1) % 3], 0.5);
                flow += a / 3 * middle.velocity;
                speed += a / 3 * middle.speed;
                pressure += a / 3 * middle.pressure;
                flow_pressure += a / 3 * middle.velocity * middle.pressure;
            }
        }
    }
};

/// Values of cells, spread to the nodes, lose what the walls hold back: beside a wall the mean of the nodes is not the
/// value of the cell. What is missing in each cell, so that sums over cuts are those of the cells.
void keep_what_spreading_lost(vtkUnstructuredGrid& volume, const std::string& name) {
    auto* in_cells = volume.GetCellData()->GetArray(name.c_str());
    auto* at_nodes = volume.GetPointData()->GetArray(name.c_str());
    if (in_cells == nullptr || at_nodes == nullptr) {
        return;
    }
    vtkNew<vtkDoubleArray> lost;
    lost->SetName((name + "_lost").c_str());
    lost->SetNumberOfComponents(in_cells->GetNumberOfComponents());
    lost->SetNumberOfTuples(volume.GetNumberOfCells());
    vtkNew<vtkIdList> ids;
    for (vtkIdType cell = 0; cell < volume.GetNumberOfCells(); ++cell) {
        volume.GetCellPoints(cell, ids);
        for (int k = 0; k < in_cells->GetNumberOfComponents(); ++k) {
            double mean = 0;
            for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i) {
                mean += at_nodes->GetComponent(ids->GetId(i), k);
            }
            lost->SetComponent(cell, k,
                               in_cells->GetComponent(cell, k) -
                                   mean / static_cast<double>(std::max<vtkIdType>(1, ids->GetNumberOfIds())));
        }
    }
    volume.GetCellData()->AddArray(lost);
}

/// Base, axes and volume, ready for cuts.
class Gap {
public:
    Gap(const Field& field, const GapOptions& options) : axes_(vehicle_axes(options.forward, options.up)) {
        for (const auto& zone : field.zones) {
            if (zone.surface != nullptr && zone.surface->GetNumberOfPolys() > 0 && matches(options.base, zone.name)) {
                base_.push_back(&zone);
            }
        }
        if (base_.empty()) {
            throw core::InputError("zone", "no zone fits '" + options.base + "' as the base above the gap",
                                   place_of(field), "name it (option 'base')");
        }
        place_mirror_by_body(field, options);
        volume_ = volume_with(field, {"velocity", "pressure"});
        if (volume_ == nullptr || volume_->GetPointData()->GetArray("velocity") == nullptr) {
            throw core::InputError("missing", "the flow through the gap needs a volume with a velocity",
                                   place_of(field), "CFD-Post surfaces do not hold one");
        }
        keep_what_spreading_lost(*volume_, "velocity");
        keep_what_spreading_lost(*volume_, "pressure");
        for (const Zone* zone : base_) {
            Box one{};
            zone->surface->GetCellsBounds(one.data());
            widen(box_, one);
        }
        centre_ = {0.5 * (box_[0] + box_[1]), 0.5 * (box_[2] + box_[3]), 0.5 * (box_[4] + box_[5])};
        half_ = 0.5 * std::abs(dot({box_[1] - box_[0], box_[3] - box_[2], box_[5] - box_[4]}, axes_.forward));
    }

    [[nodiscard]] double half_length() const { return half_; }
    [[nodiscard]] const Point& centre() const { return centre_; }
    [[nodiscard]] vtkUnstructuredGrid& volume() const { return *volume_; }
    [[nodiscard]] const VehicleAxes& axes() const { return axes_; }
    [[nodiscard]] const std::vector<std::string>& said() const {
        return said_;
    }  ///< of the plane, where nobody said where it lies
    [[nodiscard]] bool is_half() const { return mirror_.axis >= 0; }

    /// Extent of the base across the station: its sides and its highest point there.
    struct Section {
        double left = 0, right = 0, height = 0;
        bool found = false;
    };
    [[nodiscard]] Section section_of_base(double position) const {
        Section s;
        s.left = s.height = std::numeric_limits<double>::infinity();
        s.right = -s.left;
        s.height = -std::numeric_limits<double>::infinity();
        for (const Zone* zone : base_) {
            const DrawnSurface drawn = drawn_surface(*zone, "");
            for (const auto& triangle : drawn.triangles) {
                for (std::size_t k = 0; k < 3; ++k) {
                    const Point& a = drawn.points[static_cast<std::size_t>(triangle[k])];
                    const Point& b = drawn.points[static_cast<std::size_t>(triangle[(k + 1) % 3])];
                    const double da = dot(plus(a, centre_, -1), axes_.forward) - position;
                    const double db = dot(plus(b, centre_, -1), axes_.forward) - position;
                    if ((da <= 0) == (db <= 0)) {
                        continue;
                    }
                    const Point p = plus(a, plus(b, a, -1), da / (da - db));
                    s.left = std::min(s.left, dot(p, axes_.starboard));
                    s.right = std::max(s.right, dot(p, axes_.starboard));
                    s.height = std::max(s.height, dot(p, axes_.up));
                    s.found = true;
                }
            }
        }
        return s;
    }

    [[nodiscard]] Sums flow_at(double position, const Section& section) const {
        vtkNew<vtkPlane> plane;
        const Point through = plus(centre_, axes_.forward, position);
        plane->SetOrigin(through.data());
        plane->SetNormal(axes_.forward.data());
        vtkNew<vtkCutter> cutter;
        cutter->SetInputData(volume_);
        cutter->SetCutFunction(plane);
        vtkNew<vtkTriangleFilter> triangles;
        triangles->SetInputConnection(cutter->GetOutputPort());
        triangles->PassLinesOff();
        triangles->PassVertsOff();
        triangles->Update();
        const SurfaceArrays cut(*triangles->GetOutput());
        auto* velocity = triangles->GetOutput()->GetPointData()->GetArray("velocity");
        auto* pressure = triangles->GetOutput()->GetPointData()->GetArray("pressure");
        auto* lost_velocity = triangles->GetOutput()->GetCellData()->GetArray("velocity_lost");
        auto* lost_pressure = triangles->GetOutput()->GetCellData()->GetArray("pressure_lost");
        Sums sums;
        for (std::size_t f = 0; f < cut.faces(); ++f) {
            Point more_velocity{};
            if (lost_velocity != nullptr) {
                lost_velocity->GetTuple(static_cast<vtkIdType>(f), more_velocity.data());
            }
            const double more_pressure =
                lost_pressure == nullptr ? 0 : lost_pressure->GetComponent(static_cast<vtkIdType>(f), 0);
            std::vector<Corner> polygon;
            for (Index i = cut.offsets()[f]; i < cut.offsets()[f + 1]; ++i) {
                const Index node = cut.connectivity()[static_cast<std::size_t>(i)];
                const double* x = cut.points().data() + 3 * node;
                Point v{};
                velocity->GetTuple(node, v.data());
                v = plus(v, more_velocity);
                polygon.push_back({dot({x[0], x[1], x[2]}, axes_.starboard), dot({x[0], x[1], x[2]}, axes_.up),
                                   -dot(v, axes_.forward), std::sqrt(dot(v, v)),
                                   pressure == nullptr ? 0 : pressure->GetComponent(node, 0) + more_pressure});
            }
            polygon = clipped(polygon, &Corner::side, section.left, -1);
            polygon = clipped(polygon, &Corner::side, section.right, 1);
            sums.add(clipped(polygon, &Corner::height, section.height, 1));
        }
        return sums;
    }

    /// To starboard: the middle of the section of the whole base, just inside the water of half a model.
    [[nodiscard]] double middle_of(const Section& section) const {
        if (!is_half()) {
            return 0.5 * (section.left + section.right);
        }
        const double plane = mirror_.at * axes_.starboard[static_cast<std::size_t>(mirror_.axis)];
        const double inside = section.left + section.right > 2 * plane ? 1 : -1;
        return plane + inside * 1e-3 * std::max(std::abs(section.left - plane), std::abs(section.right - plane));
    }

private:
    void place_mirror_by_body(const Field& field, const GapOptions& options) {
        std::vector<const Zone*> body =
            surfaces_of_body(field, options.zones, options.base, mirror_plane_from(options.symmetry).is_half());
        for (const Zone* zone : base_) {
            if (std::find(body.begin(), body.end(), zone) == body.end()) {
                body.push_back(zone);
            }
        }
        core::Problems problems;
        mirror_ = mirror_of(options.symmetry, body, field, problems);
        for (const auto& problem : problems) {
            said_.push_back(problem.message);
        }
        if (is_half() && std::abs(axes_.starboard[static_cast<std::size_t>(mirror_.axis)]) < 0.999) {
            throw core::UsageError(
                "usage", "the symmetry plane of a half model looks to its side, not along '" + options.symmetry + "'",
                {}, "the flow under the base is that of both halves, port and starboard");
        }
    }

    VehicleAxes axes_;
    PlacedMirror mirror_;
    std::vector<std::string> said_;
    std::vector<const Zone*> base_;
    vtkSmartPointer<vtkUnstructuredGrid> volume_;
    Box box_ = empty_box();
    Point centre_{};
    double half_ = 0;
};

}  // namespace

core::Table gap_flow(const Field& field, const GapOptions& options, core::Progress& progress) {
    if (options.stations < 1) {
        throw core::UsageError("usage", "one station at least");
    }
    const Gap gap(field, options);
    const double halves = gap.is_half() ? 2 : 1;
    const auto density = options.density ? options.density : field.density;
    std::vector<double> position, width, area, flow, mass, bulk, speed, pressure, bulk_pressure;
    for (int i = 0; i < options.stations; ++i) {
        progress.check();
        progress.report(static_cast<double>(i) / options.stations, "sections of the gap");
        // Away from the very ends, where the section has no width.
        const double at = gap.half_length() * (2 * (i + 0.5) / options.stations - 1);
        const auto section = gap.section_of_base(at);
        const Sums sums = section.found ? gap.flow_at(at, section) : Sums();
        const bool some = sums.area > 0;
        position.push_back(at);
        width.push_back(section.found ? halves * (section.right - section.left) : 0);
        area.push_back(halves * sums.area);
        flow.push_back(halves * sums.flow);
        mass.push_back(halves * sums.flow * density.value_or(0));
        bulk.push_back(some ? sums.flow / sums.area : std::numeric_limits<double>::quiet_NaN());
        speed.push_back(some ? sums.speed / sums.area : std::numeric_limits<double>::quiet_NaN());
        pressure.push_back(some ? sums.pressure / sums.area : std::numeric_limits<double>::quiet_NaN());
        bulk_pressure.push_back(sums.flow != 0 ? sums.flow_pressure / sums.flow
                                               : std::numeric_limits<double>::quiet_NaN());
    }
    core::Table table;
    table.comments = gap.said();
    table.add_numbers("position", "m", position);
    table.add_numbers("width", "m", width);
    table.add_numbers("area", "m^2", area);
    table.add_numbers("volume_flow", "m^3/s", flow);
    if (density) {
        table.add_numbers("mass_flow", "kg/s", mass);
    }
    table.add_numbers("bulk_velocity", "m/s", bulk);
    table.add_numbers("mean_speed", "m/s", speed);
    if (gap.volume().GetPointData()->GetArray("pressure") != nullptr) {
        table.add_numbers("mean_pressure", "Pa", pressure);
        table.add_numbers("bulk_pressure", "Pa", bulk_pressure);
    }
    return table;
}

core::Figure gap_profile_figure(const Field& field, const GapOptions& options, core::Progress& progress) {
    const Gap gap(field, options);
    const double ground = lowest(gap.volume(), gap.axes().up);
    core::Figure figure;
    figure.title = "velocity across the gap at places along the base (+: forward of its middle)";
    figure.x = {"velocity of the stream", "m/s"};
    figure.y = {"height over the ground", "mm"};
    figure.caption =
        "Velocity against the forward axis between ground and base, in the middle plane, at stations along the base "
        "(position from its centre, forward positive).";
    for (const auto& said : gap.said()) {
        figure.caption += " Note: " + said + ".";
    }
    std::size_t colour = 0;
    for (const double share : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
        progress.check();
        const double at = share * gap.half_length();
        const auto section = gap.section_of_base(at);
        if (!section.found) {
            continue;
        }
        Point foot = plus(gap.centre(), gap.axes().forward, at);
        foot = plus(foot, gap.axes().starboard, gap.middle_of(section) - dot(foot, gap.axes().starboard));
        foot = plus(foot, gap.axes().up, ground - dot(foot, gap.axes().up));
        ProbeOptions arrays;
        arrays.arrays = {"velocity"};
        constexpr int count = 61;
        const double gap_height = section.height - ground;
        const core::Table line =
            probe_line(field, plus(foot, gap.axes().up, 1e-4 * gap_height),
                       plus(foot, gap.axes().up, (1 - 1e-4) * gap_height), count, arrays, progress);
        core::FigureCurve curve;
        curve.name = std::string(at > 0 ? "+" : "") + core::format_number(1000 * at, 3) + " mm";
        curve.colour = core::palette(colour++);
        for (std::size_t i = 0; i < count; ++i) {
            const Point v = {line.numbers("velocity_x")[i], line.numbers("velocity_y")[i],
                             line.numbers("velocity_z")[i]};
            if (std::isfinite(v[0])) {
                curve.x.push_back(-dot(v, gap.axes().forward));
                curve.y.push_back(1000 * gap_height * (1e-4 + (1 - 2e-4) * static_cast<double>(i) / (count - 1)));
            }
        }
        figure.curves.push_back(std::move(curve));
    }
    return figure;
}

}  // namespace underbody::postproc
