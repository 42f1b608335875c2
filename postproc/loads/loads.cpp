#include "postproc/loads/loads.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "core/units.h"
#include "postproc/loads/body_zones.h"
#include "postproc/loads/declared.h"
#include "postproc/loads/fluid_side.h"
#include "postproc/loads/half_model.h"
#include "postproc/loads/loads_reference_point.h"
#include "postproc/loads/lone_values.h"
#include "postproc/loads/mirror_plane.h"
#include "postproc/loads/named_loads.h"
#include "postproc/loads/vehicle_axes.h"

namespace underbody::postproc {

namespace {

using core::InputError;
using core::Problem;
using Severity = Problem::Severity;

std::string shown(const Vector& v) {
    return "(" + core::format_number(v[0], 4) + ", " + core::format_number(v[1], 4) + ", " +
           core::format_number(v[2], 4) + ")";
}

using Part = SummedZone;

class Integrator {
public:
    Integrator(const Field& field, const LoadsOptions& options, core::Progress& progress)
        : field_(field),
          options_(options),
          progress_(progress),
          revolved_(is_body_of_revolution(field, options)),
          plane_(mirror_plane_from(options.symmetry)) {
        result_.file = field.files.empty() ? "" : field.files.front();
        for (const auto& [name, value] : field.metadata) {
            const auto number = name == "time" || name == "flow-time" ? core::parse_number(value) : std::nullopt;
            if (number && (name == "time" || *number != 0)) {  // a steady run of Fluent says 0
                result_.time = number;
            }
        }
        mirror_.axis = plane_.axis;
        set_axes();
    }

    LoadsResult run() {
        refuse_importer_errors();
        parts_ = zones_to_sum(field_, options_, result_);
        find_extent();
        place_mirror();
        choose_reference();
        for (auto& part : parts_) {
            progress_.check();
            part.sums = integrate_faces(*part.surface, part.values, half_reference_, progress_);
            refuse_missing_values(part, field_, result_.file);
        }
        refuse_no_solution(parts_, field_, result_, options_.accept_problems);
        warn_of_lone_values(parts_, result_);
        settle();
        add_up();
        audit();
        stations();
        coefficients();
        return std::move(result_);
    }

private:
    [[nodiscard]] core::Place place() const { return {result_.file, {}, {}, {}}; }
    void warn(std::string text) { result_.problems.push_back({Severity::warning, std::move(text), {}}); }
    void note(std::string text) { result_.problems.push_back({Severity::note, std::move(text), {}}); }

    void set_axes() {
        Vector up = options_.up;
        if (revolved_ && mirror_.axis >= 0) {
            throw core::UsageError("usage", "an axisymmetric case is whole already", {},
                                   "leave option 'symmetry' away");
        }
        result_.dimension = field_.dimension;
        if (field_.dimension == 2) {
            result_.depth = revolved_ ? "of the whole body of revolution" : "per metre depth";
            note(revolved_ ? "axisymmetric: forces are those on the whole body of revolution about the x axis; across "
                             "it they cancel"
                           : "two-dimensional: forces and moments are per metre depth");
            if (std::abs(options_.forward[2]) > 0.5 * norm(options_.forward)) {
                throw core::UsageError("usage", "in a two-dimensional case forward lies in its plane", {},
                                       "for instance option 'forward +x' and option 'up +y'");
            }
            if (std::abs(options_.up[2]) > 0.5 * norm(options_.up)) {
                const bool along_y = std::abs(options_.forward[1]) > std::abs(options_.forward[0]);
                up = along_y ? Vector{1, 0, 0} : Vector{0, 1, 0};
                note(std::string("two-dimensional: up is ") + (along_y ? "+x" : "+y"));
            }
        }
        axes_ = vehicle_axes(options_.forward, up);
        if (field_.dimension == 3) {  // a plane case has its lift in its plane, and may be half a section
            check_mirror_lies_along(plane_, axes_.forward, axes_.up);
        }
        if (revolved_ && std::abs(axes_.forward[0]) < 1 - 1e-6) {
            throw core::UsageError("usage", "an axisymmetric case has its axis along x: forward lies along it", {},
                                   "option 'forward +x' or option 'forward -x'");
        }
        result_.forward = axes_.forward;
        result_.up = axes_.up;
        result_.starboard = axes_.starboard;
        result_.mirror_axis = mirror_.axis;
    }

    void refuse_importer_errors() {
        for (const auto& problem : field_.problems) {
            if (problem.severity != Severity::error) {
                continue;
            }
            if (!options_.accept_problems) {
                throw InputError("file", problem.message, problem.place,
                                 "export the file again, or go on with option 'accept-problems'");
            }
            result_.problems.push_back(problem);
        }
    }

    void settle_what_was_left_out() {
        std::vector<std::string> body;
        std::string list;
        for (const auto& part : parts_) {
            body.push_back(part.name);
            if (list.empty() || !(list.ends_with("," + part.zone->name) || list == part.zone->name)) {
                list += (list.empty() ? "" : ",") + part.zone->name;
            }
        }
        std::string others;
        for (const auto& zone : result_.left_out) {
            if (zone.by != LeftOutZone::By::shape) {
                continue;
            }
            others += (others.empty() ? "zone '" : "; zone '") + zone.name + "': " + zone.why;
        }
        if (result_.closure > closed_within) {
            const std::string half = cut_across();
            throw InputError("zone",
                             "which walls are the body? " + others + ". The others (" + quoted(body) +
                                 ") are not closed either (closure " + core::format_number(result_.closure, 3) + ")",
                             place(),
                             (half.empty() ? "" : half_model_advice(half) + "; ") +
                                 "name the body's zones: option 'zones " + list +
                                 "', or sum over every wall: option 'zones *'");
        }
        warn("left out of the sum: " + others + ". The loads are those on " + quoted(body) +
             ", which close; option 'zones *' sums over every wall");
    }

    // ---- where ----

    void find_extent() {
        extent_ = extent_of(parts_);
        if (revolved_) {  // the strips lie flat, see `zones_to_sum`
            const double radius = extent_.upper[1];
            extent_.lower = {extent_.lower[0], -radius, -radius};
            extent_.upper = {extent_.upper[0], radius, radius};
        }
    }

    void place_mirror() {
        std::vector<const SurfaceArrays*> body;
        for (const auto& part : parts_) {
            body.push_back(part.surface.get());
        }
        mirror_ = postproc::place_mirror(plane_, body, place(), result_.problems);
    }

    void choose_reference() {
        if (options_.reference) {
            result_.reference = *options_.reference;
            result_.reference_from = "given";
        } else if (revolved_) {
            result_.reference = {0.5 * (extent_.lower[0] + extent_.upper[0]), 0, 0};
            result_.reference_from = "middle of the body on its axis";
        } else {
            const MomentReference reference = reference_from_base(parts_, options_.base, axes_.up, mirror_);
            result_.reference = reference.point;
            result_.reference_from = reference.from;
            if (!reference.base_found) {
                warn("no zone is called '" + options_.base + "': moments are taken about the " + reference.from);
            }
        }
        half_reference_ = result_.reference;
        if (mirror_.axis >= 0) {
            half_reference_[static_cast<std::size_t>(mirror_.axis)] = mirror_.at;  // mirroring is about the plane
        }
        if (revolved_) {
            half_reference_[1] = half_reference_[2] = 0;  // and turning about the axis
        }
    }

    // ---- sums ----

    void settle() {
        if (options_.fluid != FluidSide::automatic) {
            for (auto& part : parts_) {
                part.sign = options_.fluid == FluidSide::as_in_file ? 1 : -1;
            }
            result_.orientation = options_.fluid == FluidSide::as_in_file
                                      ? "node order of the file, as asked for"
                                      : "node order of the file turned, as asked for";
            return;
        }
        const Facing facing = facing_of(parts_);
        if (facing.guessed && settle_with_other_walls()) {
            return;
        }
        result_.orientation = facing.how;
        result_.problems.insert(result_.problems.end(), facing.problems.begin(), facing.problems.end());
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            parts_[i].sign = facing.signs[i];
        }
    }

    [[nodiscard]] Facing facing_of(const std::vector<Part>& parts) const {
        std::vector<FacingZone> zones;
        for (const auto& part : parts) {
            zones.push_back({part.name, part.surface.get(), part.sums, part.zone->normals_into_fluid});
        }
        return settle_facing(zones,
                             revolved_                                   ? 1
                             : mirror_.axis < 0 && field_.dimension == 2 ? 2
                                                                         : mirror_.axis,
                             half_reference_, field_.dimension);
    }

    /// A flat base alone has no inside: the body's walls that were not asked for say on which side the fluid is.
    /// False when they do not either.
    bool settle_with_other_walls() {
        if (options_.zones.empty()) {
            return false;
        }
        LoadsOptions all = options_;
        all.zones.clear();
        std::vector<Part> body;
        try {
            LoadsResult not_used;
            body = zones_to_sum(field_, all, not_used);
        } catch (const InputError&) {
            return false;  // the file's other walls cannot be taken for a body
        }
        for (auto& part : body) {
            part.sums = integrate_faces(*part.surface, part.values, half_reference_, progress_);
        }
        const Facing facing = facing_of(body);
        std::vector<double> signs;
        for (const auto& part : parts_) {
            const auto same = std::find_if(body.begin(), body.end(), [&](const Part& other) {
                return other.zone == part.zone && other.name == part.name;
            });
            if (facing.guessed || same == body.end()) {
                return false;
            }
            signs.push_back(facing.signs[static_cast<std::size_t>(same - body.begin())]);
        }
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            parts_[i].sign = signs[i];
        }
        result_.orientation = facing.how + ", told with the body's walls that are not summed";
        return true;
    }

    /// Both halves (or all the way round the axis), and the moment moved from there to the reference point.
    [[nodiscard]] Wrench whole(const Vector& force, const Vector& moment) const {
        Wrench wrench{force, moment};
        if (mirror_.axis >= 0) {
            for (int k = 0; k < 3; ++k) {
                const auto i = static_cast<std::size_t>(k);
                wrench.force[i] *= k == mirror_.axis ? 0 : 2;
                wrench.moment[i] *= k == mirror_.axis ? 2 : 0;  // a moment is a pseudo-vector
            }
        }
        if (revolved_) {
            wrench.force[1] = wrench.force[2] = 0;
            wrench.moment[1] = wrench.moment[2] = 0;
        }
        wrench.moment = plus(wrench.moment, cross(plus(half_reference_, result_.reference, -1), wrench.force));
        return wrench;
    }

    [[nodiscard]] NamedLoads named(const Wrench& wrench) const { return named_loads(wrench, axes_); }

    /// Shells of one zone are given as one.
    void add(ZoneLoads&& zone) {
        if (result_.zones.empty() || result_.zones.back().name != zone.name) {
            result_.zones.push_back(std::move(zone));
            return;
        }
        ZoneLoads& sum = result_.zones.back();
        sum.faces += zone.faces;
        sum.area += zone.area;
        sum.area_vector = plus(sum.area_vector, zone.area_vector);
        sum.pressure = {plus(sum.pressure.force, zone.pressure.force), plus(sum.pressure.moment, zone.pressure.moment)};
        sum.viscous = {plus(sum.viscous.force, zone.viscous.force), plus(sum.viscous.moment, zone.viscous.moment)};
        sum.turned = sum.turned || zone.turned;
    }

    void add_up() {
        Vector area_vector{};
        for (const auto& part : parts_) {
            ZoneLoads zone;
            zone.name = part.zone->name;
            zone.faces = part.surface->faces();
            zone.area = part.sums.area * (mirror_.axis >= 0 ? 2 : 1);
            const auto turned = [&](const Vector& v) {
                return Vector{part.sign * v[0], part.sign * v[1], part.sign * v[2]};
            };
            zone.area_vector = whole(turned(part.sums.area_vector), {}).force;
            zone.pressure = whole(turned(part.sums.pressure_force), turned(part.sums.pressure_moment));
            zone.viscous = whole(part.sums.shear_force, part.sums.shear_moment);
            zone.turned = part.sign < 0;
            result_.area += zone.area;
            area_vector = plus(area_vector, zone.area_vector);
            result_.pressure = {plus(result_.pressure.force, zone.pressure.force),
                                plus(result_.pressure.moment, zone.pressure.moment)};
            result_.viscous = {plus(result_.viscous.force, zone.viscous.force),
                               plus(result_.viscous.moment, zone.viscous.moment)};
            add(std::move(zone));
        }
        result_.total = {plus(result_.pressure.force, result_.viscous.force),
                         plus(result_.pressure.moment, result_.viscous.moment)};
        result_.named = named(result_.total);
        result_.named_pressure = named(result_.pressure);
        result_.named_viscous = named(result_.viscous);
        take_solver_references();
        result_.extent = {extent_along(axes_.forward), extent_along(axes_.starboard), extent_along(axes_.up)};
        result_.length = options_.references.length.value_or(extent_along(axes_.forward));
        result_.closure = result_.area > 0 ? norm(area_vector) / result_.area : 0;
        for (std::size_t k = 0; k < 3; ++k) {
            result_.force_per_reference_pascal[k] = area_vector[k] == 0 ? 0 : -area_vector[k];
        }
        const double vertical = result_.named.lift_force;
        if (std::abs(vertical) > 1e-3 * norm(result_.total.force) && vertical != 0) {
            result_.centre_of_pressure = plus(result_.reference, axes_.forward, result_.named.pitch_moment / vertical);
        }
    }

    void audit() {
        if (std::any_of(result_.left_out.begin(), result_.left_out.end(),
                        [](const LeftOutZone& zone) { return zone.by == LeftOutZone::By::shape; })) {
            settle_what_was_left_out();
        }
        look_into_mirror_plane();
        if (auto fault = base_fault(result_, options_.base); fault && !revolved_) {
            result_.problems.push_back(std::move(*fault));
        }
        if (!(result_.closure > 1e-9)) {
            return;
        }
        // An absolute pressure on an open surface is a large force of no meaning: measured against that, a kilopascal
        // would look harmless. So the mean pressure does not count as force.
        const Vector& per_pascal = result_.force_per_reference_pascal;
        const double force =
            std::min(norm(result_.total.force), norm(plus(result_.total.force, per_pascal, -mean_pressure())));
        if (1000 * norm(per_pascal) > 0.01 * force) {
            std::string text =
                "the surface is not closed (closure " + core::format_number(result_.closure, 3) +
                "): 1 kPa of reference pressure would change the force by " +
                shown({1000 * result_.force_per_reference_pascal[0], 1000 * result_.force_per_reference_pascal[1],
                       1000 * result_.force_per_reference_pascal[2]}) +
                " N";
            const std::string one = opening_zone();
            result_.cut_across = one.empty() ? cut_across() : "";
            warn(text + (!one.empty() ? "; it closes without zone '" + one +
                                            "' (a ground?): name the zones of the body (option 'zones')"
                         : result_.cut_across.empty() ? ""
                                                      : "; " + half_model_advice(result_.cut_across)));
        }
    }

    /// Of faces that lie in a plane across an axis (m^2): a half model has none in its plane, a ground nothing else.
    [[nodiscard]] double area_in_plane(std::size_t axis, double at) const {
        const double slack = 1e-4 * norm(plus(extent_.upper, extent_.lower, -1));
        double area = 0;
        for (const auto& part : parts_) {
            const auto& surface = *part.surface;
            for (std::size_t f = 0; f < surface.faces(); ++f) {
                bool inside = true;
                for (auto i = surface.offsets()[f]; inside && i < surface.offsets()[f + 1]; ++i) {
                    inside = std::abs(surface.points()[3 * static_cast<std::size_t>(
                                                               surface.connectivity()[static_cast<std::size_t>(i)]) +
                                                       axis] -
                                      at) < slack;
                }
                area += inside ? integrate_face(surface, {}, {}, f).area : 0;
            }
        }
        return area;
    }

    void look_into_mirror_plane() {
        if (mirror_.axis < 0 || field_.dimension == 2) {
            return;
        }
        refuse_a_whole_body();
        const double inside = area_in_plane(static_cast<std::size_t>(mirror_.axis), mirror_.at);
        if (inside > 1e-3 * result_.area) {
            warn(core::format_number(inside, 3) +
                 " m^2 of the surface lie in the symmetry plane itself, where a half model has no wall: is that a "
                 "ground, or the plane of symmetry? name the zones of the body (option 'zones')");
        }
    }

    /// What closes by itself is no half of anything; two of them side by side have a plane that somebody states.
    void refuse_a_whole_body() const {
        if (plane_.at) {
            return;
        }
        FaceSums sums;
        for (const auto& part : parts_) {
            sums.area += part.sums.area;
            sums.area_vector = plus(sums.area_vector, part.sums.area_vector, part.sign);
            sums.flux_of_place = plus(sums.flux_of_place, part.sums.flux_of_place, part.sign);
        }
        if (bounds_a_volume(sums)) {
            const std::string axis(1, "xyz"[mirror_.axis]);
            throw InputError(
                "range", "the surface closes without a mirror image: it is no half model", place(),
                "leave option 'symmetry' away, or state the plane between two bodies side by side: option 'symmetry " +
                    axis + "=0'");
        }
    }

    /// Of all values, whatever area they stand for.
    [[nodiscard]] double mean_pressure() const {
        double sum = 0;
        std::size_t count = 0;
        for (const auto& part : parts_) {
            for (const double p : part.values.pressure) {
                sum += std::isfinite(p) ? p - part.values.reference_pressure : 0;
            }
            count += part.values.pressure.size();
        }
        return count > 0 ? sum / static_cast<double>(count) : 0;
    }

    /// The one zone without which the others bound a volume; empty when there is none.
    [[nodiscard]] std::string opening_zone() const {
        for (const auto& without : parts_) {
            FaceSums rest;
            for (const auto& part : parts_) {
                if (&part == &without) {
                    continue;
                }
                rest.area += part.sums.area;
                for (std::size_t k = 0; k < 3; ++k) {
                    const bool cancels = static_cast<int>(k) == mirror_.axis;  // with the other half
                    rest.area_vector[k] += cancels ? 0 : part.sign * part.sums.area_vector[k];
                    rest.flux_of_place[k] += part.sign * part.sums.flux_of_place[k];
                }
            }
            if (parts_.size() > 1 && bounds_a_volume(rest, field_.dimension)) {
                return without.zone->name;
            }
        }
        return {};
    }

    /// An opening that looks along one axis where the surface ends: a half model whose plane was not named.
    [[nodiscard]] std::string cut_across() const {
        if (mirror_.axis >= 0 || revolved_) {
            return {};
        }
        const Vector& open = result_.force_per_reference_pascal;
        const double size = norm(plus(extent_.upper, extent_.lower, -1));
        for (std::size_t k = 0; k < 3; ++k) {
            const bool ends_at_zero =
                std::abs(extent_.lower[k]) < 1e-3 * size || std::abs(extent_.upper[k]) < 1e-3 * size;
            if (!mirrors_motion(k, axes_.forward, axes_.up) && std::abs(open[k]) > 0.99 * norm(open) && ends_at_zero &&
                area_in_plane(k, 0) < 0.01 * norm(open)) {
                return {"xyz"[k]};
            }
        }
        return {};
    }

    // ---- along the body ----

    void stations() {
        if (options_.stations <= 0) {
            return;
        }
        const auto steps = static_cast<std::size_t>(options_.stations);
        const double from = std::min(dot(extent_.lower, axes_.forward), dot(extent_.upper, axes_.forward));
        const double to = std::max(dot(extent_.lower, axes_.forward), dot(extent_.upper, axes_.forward));
        std::vector<Wrench> slices(steps);
        for (const auto& part : parts_) {
            for (std::size_t f = 0; f < part.surface->faces(); ++f) {
                const FaceSums sums = integrate_face(*part.surface, part.values, half_reference_, f);
                const double share = (dot(centre_of(part, f), axes_.forward) - from) / (to - from);
                auto& slice = slices[std::min(
                    steps - 1, static_cast<std::size_t>(std::max(0.0, share) * static_cast<double>(steps)))];
                slice.force = plus(plus(slice.force, sums.pressure_force, part.sign), sums.shear_force);
                slice.moment = plus(plus(slice.moment, sums.pressure_moment, part.sign), sums.shear_moment);
            }
            progress_.check();
        }
        Wrench sum;
        const double at_reference = dot(result_.reference, axes_.forward);
        result_.stations.push_back({from - at_reference, {}});
        for (std::size_t i = 0; i < steps; ++i) {
            sum = {plus(sum.force, slices[i].force), plus(sum.moment, slices[i].moment)};
            result_.stations.push_back(
                {from + (to - from) * static_cast<double>(i + 1) / static_cast<double>(steps) - at_reference,
                 named(whole(sum.force, sum.moment))});
        }
    }

    /// m, of the body along an axis; with its mirror image it reaches as far on the other side, and its half need not
    /// begin at the plane.
    [[nodiscard]] double extent_along(const Vector& axis) const {
        double size = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const bool doubled = static_cast<int>(k) == mirror_.axis;
            size += std::abs(axis[k]) *
                    (doubled ? 2 * std::max(extent_.upper[k] - mirror_.at, mirror_.at - extent_.lower[k])
                             : extent_.upper[k] - extent_.lower[k]);
        }
        return size;
    }

    /// Those that a Fluent case states.
    void take_solver_references() {
        SolverReferences& references = result_.solver_references;
        references.density = options_.references.density ? options_.references.density : field_.density;
        for (const auto& [name, target] : {std::pair{"reference-density", &references.density},
                                           {"reference-velocity", &references.speed},
                                           {"reference-area", &references.area},
                                           {"reference-length", &references.length}}) {
            const auto found = std::find_if(field_.metadata.begin(), field_.metadata.end(),
                                            [&](const auto& entry) { return entry.first == name; });
            if (const auto value = found == field_.metadata.end() ? std::nullopt : core::parse_number(found->second)) {
                *target = *value;
            }
        }
    }

    void coefficients() {
        const LoadsReferences& given = options_.references;
        const Vector body{extent_along(axes_.forward), extent_along(axes_.starboard), extent_along(axes_.up)};
        constexpr double far_off = 10, far_off_some_zones = 100;  // zones that were named may be a part of the body
        const core::Problems faults =
            size_faults(given, body, options_.zones.empty() ? far_off : far_off_some_zones, place());
        result_.problems.insert(result_.problems.end(), faults.begin(), faults.end());
        const auto density = given.density ? given.density : field_.density;
        if (!density || !given.speed || !(*given.speed > 0) || !(*density > 0)) {
            return;
        }
        LoadsCoefficients c;
        c.density = *density;
        c.speed = *given.speed;
        c.length = result_.length;
        c.width = given.width.value_or(body[1]);
        c.height = given.height.value_or(body[2]);
        c.lengths_from = given.length && given.width && given.height   ? "given"
                         : given.length || given.width || given.height ? "given, others from the bounding box"
                                                                       : "bounding box";
        const bool strip = field_.dimension == 2 && !revolved_;  // one metre of it: a rectangle
        const double share = strip ? 1 : std::atan(1.0);
        const double plan = 0.5 * c.density * c.speed * c.speed * share * c.length * c.width;
        const double front = 0.5 * c.density * c.speed * c.speed * share * c.width * c.height;
        c.lift = result_.named.lift_force / plan;
        c.drag = result_.named.drag_force / front;
        c.pitch_moment = result_.named.pitch_moment / (plan * c.length);
        result_.coefficients = c;
    }

    const Field& field_;
    const LoadsOptions& options_;
    core::Progress& progress_;
    bool revolved_;
    MirrorPlane plane_;
    PlacedMirror mirror_;
    VehicleAxes axes_;
    std::vector<Part> parts_;
    Extent extent_;
    Vector half_reference_{};
    LoadsResult result_;
};

}  // namespace

Vector axis_from(const std::string& text) {
    std::string word = core::lower_case(core::trimmed(text));
    double sign = 1;
    if (!word.empty() && (word[0] == '+' || word[0] == '-')) {
        sign = word[0] == '-' ? -1 : 1;
        word.erase(0, 1);
    }
    if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') {
        throw core::UsageError("usage", "'" + text + "' is no axis", {}, "axes are +x, -x, +y, -y, +z, -z");
    }
    Vector axis{};
    axis[static_cast<std::size_t>(word[0] - 'x')] = sign;
    return axis;
}

LoadsResult loads(const Field& field, const LoadsOptions& options, core::Progress& progress) {
    return Integrator(field, options, progress).run();
}

}  // namespace underbody::postproc
