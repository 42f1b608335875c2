#include "postproc/loads/loads_parts.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "core/counted.h"
#include "core/text.h"
#include "postproc/field/connected_components.h"
#include "postproc/importers/mesh/variable_reading.h"
#include "postproc/loads/body_zones.h"
#include "postproc/loads/duplicate_faces.h"
#include "postproc/loads/mirror_plane.h"

namespace underbody::postproc {

namespace {

using core::InputError;
using Severity = core::Problem::Severity;
using Part = SummedZone;

const double pi = 4 * std::atan(1.0);
const char* const lines_hint =
    "lines bound a body only in a plane case, where they go round or its elements stand beside them: export these too";

class Chooser {
public:
    Chooser(const Field& field, const LoadsOptions& options, LoadsResult& result)
        : field_(field), options_(options), revolved_(is_body_of_revolution(field, options)), result_(result) {}

    std::vector<Part> choose() {
        choose_zones();
        return std::move(parts_);
    }

private:
    [[nodiscard]] core::Place place() const { return {result_.file, {}, {}, {}}; }
    void warn(std::string text) { result_.problems.push_back({Severity::warning, std::move(text), {}}); }

    static bool has_polygons(const Zone& zone) { return zone.surface->GetNumberOfPolys() > 0; }
    [[nodiscard]] bool is_surface(const Zone& zone) const {
        return zone.surface != nullptr &&
               (has_polygons(zone) || (field_.dimension == 2 && zone.surface->GetNumberOfLines() > 0));
    }

    /// Half the width of the strip that stands for a place of a plane case.
    [[nodiscard]] double half_width(const Zone& zone, double y) const {
        if (!revolved_) {
            return 0.5;
        }
        double bounds[6];
        zone.surface->GetBounds(bounds);
        if (y < -1e-9 * (bounds[1] - bounds[0] + bounds[3] - bounds[2])) {
            throw InputError("range",
                             "zone '" + zone.name + "' lies at y = " + core::format_number(y, 4) +
                                 " m, beyond the axis of an axisymmetric case",
                             place());
        }
        return pi * std::max(y, 0.0);
    }

    /// The lines of a plane case as a strip. The normal of a line n0 -> n1 that looks into the fluid is z x t.
    [[nodiscard]] vtkSmartPointer<vtkPolyData> extruded(const Zone& zone) const {
        vtkPolyData& lines = *zone.surface;
        const vtkIdType nodes = lines.GetNumberOfPoints();
        vtkNew<vtkPoints> points;
        points->SetDataTypeToDouble();
        for (const double side : {-1.0, 1.0}) {
            for (vtkIdType i = 0; i < nodes; ++i) {
                double x[3];
                lines.GetPoint(i, x);
                points->InsertNextPoint(x[0], x[1], side * half_width(zone, x[1]));
            }
        }
        vtkNew<vtkCellArray> quads;
        vtkNew<vtkIdList> ids;
        std::vector<vtkIdType> from;  // the line each quad came from
        for (vtkIdType c = 0; c < lines.GetNumberOfLines(); ++c) {
            lines.GetLines()->GetCellAtId(c, ids);
            for (vtkIdType i = 0; i + 1 < ids->GetNumberOfIds(); ++i) {
                const vtkIdType a = ids->GetId(i);
                const vtkIdType b = ids->GetId(i + 1);
                quads->InsertNextCell({a, a + nodes, b + nodes, b});
                from.push_back(lines.GetNumberOfVerts() + c);
            }
        }
        auto result = vtkSmartPointer<vtkPolyData>::New();
        result->SetPoints(points);
        result->SetPolys(quads);
        for (const char* name :
             {"pressure", "kinematic_pressure", "pressure_absolute", "wall_shear", "kinematic_wall_shear"}) {
            if (auto* on_lines = lines.GetCellData()->GetArray(name)) {
                auto copy = vtk::TakeSmartPointer(on_lines->NewInstance());
                copy->SetName(name);
                copy->SetNumberOfComponents(on_lines->GetNumberOfComponents());
                for (const auto line : from) {
                    copy->InsertNextTuple(line, on_lines);
                }
                result->GetCellData()->AddArray(copy);
            }
            if (auto* on_nodes = lines.GetPointData()->GetArray(name)) {
                auto copy = vtk::TakeSmartPointer(on_nodes->NewInstance());
                copy->SetName(name);
                copy->SetNumberOfComponents(on_nodes->GetNumberOfComponents());
                for (vtkIdType i = 0; i < 2 * nodes; ++i) {
                    copy->InsertNextTuple(i % nodes, on_nodes);
                }
                result->GetPointData()->AddArray(copy);
            }
        }
        return result;
    }

    /// Those that fit the patterns. A pattern with * or ? means walls where it fits any; a name means whatever bears
    /// it.
    std::vector<const Zone*> named_zones() {
        std::vector<const Zone*> excluded_by_kind;
        const std::vector<const Zone*> walls = possible_walls(field_, excluded_by_kind);
        std::vector<std::string> names;
        std::vector<const Zone*> chosen;
        for (const auto& zone : field_.zones) {
            names.push_back(zone.name);
        }
        for (const auto& pattern : options_.zones) {
            const auto fits = [&](const Zone* zone) { return matches(pattern, zone->name); };
            const bool name = pattern.find_first_of("*?") == std::string::npos ||
                              std::find(names.begin(), names.end(), pattern) != names.end();
            const bool walls_alone = !name && std::any_of(walls.begin(), walls.end(), fits);
            bool any = false;
            for (const auto& zone : field_.zones) {
                const bool fit = fits(&zone);
                any = any || fit;
                if (fit && walls_alone && std::find(walls.begin(), walls.end(), &zone) == walls.end()) {
                    note_left_out(zone, pattern);
                } else if (fit && std::find(chosen.begin(), chosen.end(), &zone) == chosen.end()) {
                    chosen.push_back(&zone);
                }
            }
            if (!any) {
                throw InputError("zone", "no zone fits '" + pattern + "'", place(), core::did_you_mean(pattern, names));
            }
        }
        std::erase_if(result_.left_out, [&](const LeftOutZone& zone) {
            return std::any_of(chosen.begin(), chosen.end(),
                               [&](const Zone* other) { return other->name == zone.name; });
        });
        std::sort(chosen.begin(), chosen.end());  // as in the file
        return chosen;
    }

    /// A surface that a pattern fits though it is no wall.
    void note_left_out(const Zone& zone, const std::string& pattern) {
        const bool known = std::any_of(result_.left_out.begin(), result_.left_out.end(),
                                       [&](const LeftOutZone& other) { return other.name == zone.name; });
        if (zone.surface != nullptr && zone.volume == nullptr && !known) {
            result_.left_out.push_back({zone.name,
                                        "'" + pattern + "' takes walls, and this is " +
                                            to_string(effective_kind(zone)) + ": its own name takes it",
                                        LeftOutZone::By::name});
        }
    }

    /// Those of the body, when nobody names any.
    std::vector<const Zone*> unnamed_zones() {
        std::vector<const Zone*> excluded_by_kind;
        std::vector<const Zone*> zones = possible_walls(field_, excluded_by_kind);
        std::erase_if(zones, [&](const Zone* zone) { return zone->kind == ZoneKind::line && field_.dimension != 2; });
        for (const Zone* zone : zones.empty() ? std::vector<const Zone*>{} : excluded_by_kind) {
            result_.left_out.push_back(
                {zone->name,
                 std::string(zone->kind == ZoneKind::unknown ? "its name says that it is no wall: "
                                                             : "it is no wall: ") +
                     to_string(effective_kind(*zone)),
                 LeftOutZone::By::name});
        }
        return zones;
    }

    std::vector<const Zone*> wanted_zones() {
        std::vector<const Zone*> zones = options_.zones.empty() ? unnamed_zones() : named_zones();
        if (zones.empty()) {
            const bool lines = std::any_of(field_.zones.begin(), field_.zones.end(),
                                           [](const Zone& zone) { return zone.kind == ZoneKind::line; });
            throw InputError("zone", "the file holds no surface to integrate over", place(),
                             lines ? lines_hint : "zones: underbody info FILE");
        }
        return zones;
    }

    /// On what the pressures that are integrated lie, for people.
    void say_where_values_are() {
        std::vector<std::string> from;
        for (const auto& part : parts_) {
            std::string word = part.values.pressure_on_nodes ? "nodes" : "faces";
            if (const auto* info = part.zone->find("pressure"); info != nullptr && info->on == Location::cells) {
                word = "cells";
            }
            if (std::find(from.begin(), from.end(), word) == from.end()) {
                from.push_back(word);
            }
        }
        std::sort(from.begin(), from.end());
        for (const auto& word : from) {
            result_.values_from += (result_.values_from.empty() ? "" : ", ") + word;
        }
    }

    void choose_zones() {
        for (const Zone* zone : wanted_zones()) {
            if (!is_surface(*zone)) {
                throw InputError("zone", "zone '" + zone->name + "' has no faces, so that forces cannot be integrated",
                                 place(),
                                 field_.format == "CFD-Post CSV"
                                     ? "export it with 'Line and Face Connectivity', or leave it out (option 'zones')"
                                 : zone->kind == ZoneKind::line ? lines_hint
                                                                : "leave it out (option 'zones')");
            }
            Part part;
            part.zone = zone;
            part.name = zone->name;
            part.polygons = has_polygons(*zone) ? zone->surface : extruded(*zone);
            part.surface = std::make_unique<SurfaceArrays>(*part.polygons);
            add_parts(std::move(part));
        }
        if (options_.zones.empty() && parts_.size() > 1) {
            leave_out_other_walls();
        }
        for (auto& part : parts_) {
            take_pressure(part);
            take_shear(part);
        }
        bring_to_one_reference();
        settle_doubled_zones();
        say_where_values_are();
    }

    /// Some of the faces of a part, with the points that these use.
    [[nodiscard]] static Part part_of(const Part& part, const std::vector<std::size_t>& faces) {
        Part some;
        some.zone = part.zone;
        some.name = part.name;
        some.polygons = surface_of_faces(*part.polygons, *part.surface, faces);
        some.surface = std::make_unique<SurfaceArrays>(*some.polygons);
        return some;
    }

    /// Without points that no face has: a surface cut out of another may bring all points of that, and what lies
    /// elsewhere is not where the body ends. A zone whose sides nobody knows may hold several closed shells, each with
    /// a winding of its own: they come apart.
    void add_parts(Part&& part) {
        ConnectedFaces connected(*part.surface);
        const auto numbers =
            part.zone->normals_into_fluid || field_.dimension == 2 ? std::vector<std::uint32_t>{} : connected.parts();
        if (connected.leaves_points_out()) {
            std::vector<std::size_t> all(part.surface->faces());
            std::iota(all.begin(), all.end(), std::size_t{0});
            part = part_of(part, all);
        }
        std::vector<Part> shells = shells_of(part, numbers);
        if (shells.empty()) {
            parts_.push_back(std::move(part));
        }
        for (std::size_t i = 0; i < shells.size(); ++i) {
            shells[i].name += " (part " + std::to_string(i + 1) + " of " + std::to_string(shells.size()) + ")";
            parts_.push_back(std::move(shells[i]));
        }
    }

    /// The closed shells of a part, and behind them what is open, together as the file has it. Nothing when that is
    /// one. `numbers`: of the connected part that each face belongs to.
    [[nodiscard]] static std::vector<Part> shells_of(const Part& part, const std::vector<std::uint32_t>& numbers) {
        constexpr std::size_t most = 1000;  // droplets
        std::vector<std::vector<std::size_t>> faces(
            numbers.empty() ? 0 : 1 + *std::max_element(numbers.begin(), numbers.end()));
        if (faces.size() > most) {
            return {};
        }
        for (std::size_t face = 0; face < numbers.size(); ++face) {
            faces[numbers[face]].push_back(face);
        }
        std::vector<Part> shells;
        std::vector<std::size_t> open;
        for (const auto& own : faces) {
            Part shell = part_of(part, own);
            if (bounds_a_volume(integrate_faces(*shell.surface, {}, {}))) {
                shells.push_back(std::move(shell));
            } else {
                open.insert(open.end(), own.begin(), own.end());
            }
        }
        if (!shells.empty() && !open.empty()) {
            shells.push_back(part_of(part, open));
        }
        return shells.size() > 1 ? std::move(shells) : std::vector<Part>{};
    }

    /// A ground or a tunnel is a wall too. `audit` refuses when the rest does not close either.
    void leave_out_other_walls() {
        std::vector<WallShape> walls;
        for (const auto& part : parts_) {
            walls.push_back(shape_of(part.name, *part.surface, part.zone->normals_into_fluid, field_.dimension));
            walls.back().surface = part.surface.get();
        }
        const auto is_other = [&](const std::string& name) {
            return std::any_of(result_.left_out.begin(), result_.left_out.end(),
                               [&](const LeftOutZone& zone) { return zone.name == name; });
        };
        for (auto& other : walls_beside_body(walls, mirror_plane_from(options_.symmetry).is_half())) {
            result_.left_out.push_back(std::move(other));
        }
        std::erase_if(parts_, [&](const Part& part) { return is_other(part.name); });
        std::erase_if(walls, [&](const WallShape& wall) { return is_other(wall.name); });
        std::erase_if(walls, [&](const WallShape& wall) {  // parts of one zone are not told from each other by name
            return std::none_of(parts_.begin(), parts_.end(), [&](const Part& part) {
                return part.name == wall.name && part.zone->name == wall.name;
            });
        });
        const auto bodies = separate_bodies(walls);
        if (!bodies.empty()) {
            warn("zones " + quoted(bodies) +
                 " are bodies of their own that lie apart: the loads are the sum over all; name those that are meant "
                 "(option 'zones')");
        }
    }

    /// A wall by its name and once more within a group would count twice.
    void settle_doubled_zones() {
        std::vector<bool> away(parts_.size(), false);
        for (const auto& doubled : doubled_zones(parts_)) {
            const std::string& name = parts_[doubled.zone].name;
            std::vector<std::string> others;
            for (const std::size_t other : doubled.others) {
                others.push_back(parts_[other].name);
            }
            const std::string faces = (doubled.whole && doubled.faces != 1 ? "all " : "") +
                                      core::counted(doubled.faces, "face") + " of zone '" + name +
                                      (doubled.faces == 1 ? "' stands in " : "' stand in ") + quoted(others) + " too";
            if (!options_.zones.empty()) {
                warn(faces + (doubled.faces == 1 ? ": what is on it counts twice" : ": what is on them counts twice"));
            } else if (doubled.whole) {
                away[doubled.zone] = true;
                result_.left_out.push_back(
                    {name, "its faces stand in " + quoted(others) + " too", LeftOutZone::By::doubled});
                warn("left out of the sum: " + faces);
            } else {
                throw InputError("zone", faces + ", and would count twice", place(),
                                 "name zones without common faces (option 'zones')");
            }
        }
        std::size_t at = 0;
        std::erase_if(parts_, [&](const Part&) { return away[at++]; });
    }

    /// Absolute pressures among gauge ones would push with the atmosphere on their zones alone.
    void bring_to_one_reference() {
        const auto absolute =
            std::count_if(parts_.begin(), parts_.end(), [](const Part& part) { return part.absolute; });
        if (absolute == 0 || absolute == static_cast<std::ptrdiff_t>(parts_.size())) {
            return;
        }
        const auto& reference = field_.pressure;
        for (auto& part : parts_) {
            if (!part.absolute) {
                continue;
            }
            if (reference.kind != PressureReference::Kind::gauge || !(reference.operating_pressure > 0)) {
                throw InputError("reference",
                                 "zone '" + part.zone->name +
                                     "' has an absolute pressure and others have a gauge pressure, and the file does "
                                     "not say what lies between",
                                 place(), "sum them apart (option 'zones')");
            }
            part.values.reference_pressure += reference.operating_pressure;
            warn("zone '" + part.zone->name +
                 "' has only an absolute pressure: " + core::format_number(reference.operating_pressure) +
                 " Pa, the file's operating pressure, was taken from it");
        }
    }

    /// The values of an array, those on faces without what lines and vertices before them have.
    static std::span<const double> summed_values(const Part& part, vtkDataArray& array, bool on_nodes,
                                                 std::vector<double>& own) {
        const auto before =
            on_nodes ? 0
                     : static_cast<std::size_t>(part.polygons->GetNumberOfVerts() + part.polygons->GetNumberOfLines());
        return values_of(array, own).subspan(before * static_cast<std::size_t>(array.GetNumberOfComponents()));
    }

    static vtkDataArray* array_of(const Part& part, const char* name, bool& on_nodes) {
        on_nodes = false;
        if (auto* array = part.polygons->GetCellData()->GetArray(name)) {
            return array;
        }
        on_nodes = true;
        return part.polygons->GetPointData()->GetArray(name);
    }

    [[noreturn]] void refuse_without_pressure(const Part& part) const {
        std::vector<std::string> names;
        for (const auto& info : part.zone->arrays) {
            names.push_back(info.name);
        }
        const auto without_unit =
            std::find_if(part.zone->arrays.begin(), part.zone->arrays.end(), [](const ArrayInfo& info) {
                return info.components == 1 && info.name == unstated_name(info.original_name);
            });
        if (without_unit != part.zone->arrays.end()) {
            const std::string& name = without_unit->original_name;
            throw InputError("missing",
                             "zone '" + part.zone->name + "' has no pressure but '" + name +
                                 "', of which the file does not say the unit",
                             place(),
                             "say it: option 'unit " + name + "=Pa', or of p/rho option 'unit " + name +
                                 "=m^2/s^2' with option 'density'");
        }
        if (names.empty()) {
            throw InputError(
                "missing", "zone '" + part.zone->name + "' has no pressure, nor any other values: this is a mesh alone",
                place(),
                field_.format.starts_with("Fluent")
                    ? "no results lie beside it under its name; give the results file (.dat, .dat.h5), with option "
                      "'mesh' if the mesh has another name"
                    : "give the file that the solver's results are in");
        }
        throw InputError("missing", "zone '" + part.zone->name + "' has no pressure", place(),
                         core::did_you_mean("pressure", names));
    }

    void take_pressure(Part& part) {
        bool on_nodes = true;
        double scale = 1;
        vtkDataArray* array = array_of(part, "pressure", on_nodes);
        if (array == nullptr) {
            array = array_of(part, "kinematic_pressure", on_nodes);
            const auto density = options_.references.density ? options_.references.density : field_.density;
            if (array != nullptr && !density) {
                throw InputError("missing",
                                 "zone '" + part.zone->name +
                                     "' has p/rho instead of a pressure, and the file does not say the density",
                                 place(), "give it: option 'density 998 kg/m^3'");
            }
            scale = density.value_or(1);
        }
        if (array == nullptr) {
            array = array_of(part, "pressure_absolute", on_nodes);
            part.absolute = array != nullptr;
        }
        if (array == nullptr) {
            refuse_without_pressure(part);
        }
        part.values.pressure = summed_values(part, *array, on_nodes, part.own_pressure);
        if (scale != 1) {
            std::vector<double> scaled(part.values.pressure.begin(), part.values.pressure.end());
            std::for_each(scaled.begin(), scaled.end(), [&](double& p) { p *= scale; });
            part.own_pressure = std::move(scaled);
            part.values.pressure = part.own_pressure;
        }
        part.values.pressure_on_nodes = on_nodes;
        part.values.reference_pressure = options_.reference_pressure;
    }

    void take_shear(Part& part) {
        bool on_nodes = true;
        vtkDataArray* array = array_of(part, "wall_shear", on_nodes);
        double scale = 1;
        if (array == nullptr) {
            array = array_of(part, "kinematic_wall_shear", on_nodes);
            scale = options_.references.density ? *options_.references.density : field_.density.value_or(std::nan(""));
            if (array != nullptr && std::isnan(scale)) {
                throw InputError(
                    "missing",
                    "zone '" + part.zone->name + "' has wall shear over density, and the file does not say the density",
                    place(), "give it: option 'density 998 kg/m^3'");
            }
        }
        if (array == nullptr || array->GetNumberOfComponents() != 3) {
            warn("zone '" + part.zone->name + "' has no wall shear vector: its viscous part is left out");
            return;
        }
        const ArrayInfo* info = part.zone->find("wall_shear");
        if (revolved_ && info != nullptr && info->original_unit == "N") {
            warn("zone '" + part.zone->name +
                 "' has forces on its faces, and of an axisymmetric case it is not known whether these are per radian: "
                 "its viscous part is left out");
            return;
        }
        part.values.shear = summed_values(part, *array, on_nodes, part.own_shear);
        if (scale != 1) {
            std::vector<double> scaled(part.values.shear.begin(), part.values.shear.end());
            std::for_each(scaled.begin(), scaled.end(), [&](double& t) { t *= scale; });
            part.own_shear = std::move(scaled);
            part.values.shear = part.own_shear;
        }
        part.values.shear_on_nodes = on_nodes;
    }

    const Field& field_;
    const LoadsOptions& options_;
    bool revolved_;
    LoadsResult& result_;
    std::vector<Part> parts_;
};

[[noreturn]] void throw_missing(const Part& part, const Field& field, const std::string& file, const std::string& name,
                                std::size_t index) {
    core::Place where{file, {}, {}, {}};
    const ArrayInfo* info = part.zone->find(name);
    for (const auto& problem : field.problems) {  // the importer noted where the first one stands
        if (info != nullptr && problem.place.line &&
            problem.message.find("'" + info->original_name.substr(0, info->original_name.size() - 2)) !=
                std::string::npos &&
            problem.message.find("zone '" + part.zone->name + "'") != std::string::npos) {
            where = problem.place;
            break;
        }
    }
    const bool nodes = name == "pressure" ? part.values.pressure_on_nodes : part.values.shear_on_nodes;
    throw InputError("missing",
                     "zone '" + part.zone->name + "': " + name + " has no finite value at " +
                         (nodes ? "node " : "face ") + std::to_string(index) + ", so that the force cannot be had",
                     where);
}

}  // namespace

bool is_body_of_revolution(const Field& field, const LoadsOptions& options) {
    const auto told = std::find(field.metadata.begin(), field.metadata.end(),
                                std::pair<std::string, std::string>{"axisymmetric", "true"});
    return field.dimension == 2 && (options.axisymmetric || told != field.metadata.end());
}

std::vector<SummedZone> zones_to_sum(const Field& field, const LoadsOptions& options, LoadsResult& result) {
    return Chooser(field, options, result).choose();
}

void refuse_missing_values(const SummedZone& part, const Field& field, const std::string& file) {
    const auto finite = [](const Vector& v) {
        return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
    };
    if (finite(part.sums.pressure_force) && finite(part.sums.shear_force)) {
        return;
    }
    for (const auto& [values, name, components] : {std::tuple{part.values.pressure, "pressure", std::size_t{1}},
                                                   std::tuple{part.values.shear, "wall_shear", std::size_t{3}}}) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (!std::isfinite(values[i])) {
                throw_missing(part, field, file, name, i / components);
            }
        }
    }
    throw InputError("range", "zone '" + part.zone->name + "' has points that are no numbers", {file, {}, {}, {}});
}

void refuse_no_solution(const std::vector<SummedZone>& parts, const Field& field, LoadsResult& result, bool accept) {
    constexpr double beyond = 1e11;  // Pa: the pressure in the middle of the Earth is four times that
    double lowest = HUGE_VAL;
    double highest = -HUGE_VAL;
    double largest = 0;
    for (const auto& part : parts) {
        for (const double p : part.values.pressure) {
            lowest = std::min(lowest, p);
            highest = std::max(highest, p);
        }
        for (const double t : part.values.shear) {
            largest = std::max(largest, std::abs(t));
        }
    }
    largest = std::max({largest, std::abs(lowest), std::abs(highest)});
    std::string what;
    if (std::isfinite(largest) && largest > beyond) {
        what = "values reach " + core::format_number(largest, 3) + " Pa on the body: the solution has diverged";
    } else if (field.format == "OpenFOAM" && result.time && *result.time == 0 && lowest == highest) {
        what = "the case has no time but 0, with one pressure everywhere: these are initial values, not a solution";
    }
    if (what.empty()) {
        return;
    }
    if (!accept) {
        throw InputError("solution", what, {result.file, {}, {}, {}});
    }
    result.problems.push_back({core::Problem::Severity::warning, what, {}});
}

std::string quoted(const std::vector<std::string>& names) {
    std::string text;
    for (const auto& name : names) {
        text += (text.empty() ? "'" : ", '") + name + "'";
    }
    return text;
}

}  // namespace underbody::postproc
