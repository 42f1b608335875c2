#include "postproc/loads.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "core/units.h"
#include "postproc/facing.h"
#include "postproc/loads_parts.h"

namespace underbody::postproc {

namespace {

using core::InputError;
using core::Problem;
using Severity = Problem::Severity;

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double norm(const Vector& a) { return std::sqrt(dot(a, a)); }
Vector plus(const Vector& a, const Vector& b, double scale = 1) { return {a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]}; }

std::string shown(const Vector& v) {
    return "(" + core::format_number(v[0], 4) + ", " + core::format_number(v[1], 4) + ", " + core::format_number(v[2], 4) + ")";
}

/// A half model's plane.
struct Mirror {
    int axis = -1;
    double at = 0;
    bool stated = false;
};

Mirror mirror_from(const std::string& text) {
    Mirror mirror;
    if (text.empty() || text == "none") {
        return mirror;
    }
    const auto equals = text.find('=');
    const std::string axis = core::lower_case(core::trimmed(std::string_view(text).substr(0, equals)));
    if (axis.size() != 1 || axis[0] < 'x' || axis[0] > 'z') {
        throw core::UsageError("usage", "'" + text + "' is no symmetry plane", {}, "give its normal axis: --symmetry y, or --symmetry y=0.1");
    }
    mirror.axis = axis[0] - 'x';
    if (equals != std::string::npos) {
        mirror.at = core::parse_in(text.substr(equals + 1), "m");
        mirror.stated = true;
    }
    return mirror;
}

using Part = SummedZone;

struct Axes {
    Vector forward, up, starboard;
};

class Integrator {
public:
    Integrator(const Field& field, const LoadsOptions& options, core::Progress& progress)
        : field_(field), options_(options), progress_(progress), mirror_(mirror_from(options.symmetry)) {
        result_.file = field.files.empty() ? "" : field.files.front();
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
        const auto unit = [](const Vector& v, const char* name) {
            const double size = norm(v);
            if (!(size > 0)) {
                throw core::UsageError("usage", std::string("the ") + name + " axis has no direction");
            }
            return Vector{v[0] / size, v[1] / size, v[2] / size};
        };
        axes_.forward = unit(options_.forward, "forward");
        axes_.up = unit(options_.up, "up");
        if (field_.dimension == 2) {
            note("two-dimensional: forces and moments are per metre depth");
            if (std::abs(axes_.up[2]) > 0.5) {
                axes_.up = {0, 1, 0};
                note("two-dimensional: up is +y");
            }
        }
        if (std::abs(dot(axes_.forward, axes_.up)) > 1e-6) {
            throw core::UsageError("usage", "forward and up are not perpendicular", {}, "for instance --forward +x --up +z");
        }
        axes_.starboard = cross(axes_.forward, axes_.up);
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
                throw InputError("file", problem.message, problem.place, "export the file again, or go on with --accept-problems");
            }
            result_.problems.push_back(problem);
        }
    }

    void tell_what_was_left_out() {
        std::vector<std::string> body;
        std::string list;
        for (const auto& part : parts_) {
            body.push_back(part.zone->name);
            list += (list.empty() ? "" : ",") + part.zone->name;
        }
        std::string others;
        for (const auto& zone : result_.left_out) {
            others += (others.empty() ? "zone '" : "; zone '") + zone.name + "': " + zone.why;
        }
        constexpr double closed = 1e-3;
        if (result_.closure > closed) {
            const std::string half = half_model_hint();
            throw InputError("zone", "which walls are the body? " + others + ". The others (" + quoted(body) + ") are not closed either (closure " +
                                         core::format_number(result_.closure, 3) + ")", place(),
                             (half.empty() ? "" : half + "; ") + "name the body's zones: --zones '" + list + "', or sum over every wall: --zones '*'");
        }
        warn("left out of the sum: " + others + ". The loads are those on " + quoted(body) + ", which close; --zones '*' sums over every wall");
    }

    // ---- where ----

    void find_extent() {
        lower_.fill(std::numeric_limits<double>::infinity());
        upper_.fill(-std::numeric_limits<double>::infinity());
        for (const auto& part : parts_) {
            widen(part, lower_, upper_);
        }
    }

    static void widen(const Part& part, Vector& lower, Vector& upper) {
        const auto points = part.surface->points();
        for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
            for (std::size_t k = 0; k < 3; ++k) {
                lower[k] = std::min(lower[k], points[i + k]);
                upper[k] = std::max(upper[k], points[i + k]);
            }
        }
    }

    void place_mirror() {
        if (mirror_.axis < 0) {
            return;
        }
        const auto k = static_cast<std::size_t>(mirror_.axis);
        const double size = norm(plus(upper_, lower_, -1));
        if (!mirror_.stated && lower_[k] < -1e-3 * size && upper_[k] > 1e-3 * size) {
            mirror_.at = 0;  // on both sides: refused below
        } else if (!mirror_.stated) {
            mirror_.at = std::abs(lower_[k]) <= std::abs(upper_[k]) ? lower_[k] : upper_[k];
            if (std::abs(mirror_.at) <= 1e-3 * size) {
                mirror_.at = 0;
            } else {
                warn(std::string("the symmetry plane is taken at ") + "xyz"[k] + " = " + core::format_number(mirror_.at, 4) + " m, where the surface ends");
            }
        }
        if (lower_[k] < mirror_.at - 1e-3 * size && upper_[k] > mirror_.at + 1e-3 * size) {
            throw InputError("range", std::string("the surface lies on both sides of ") + "xyz"[k] + " = " + core::format_number(mirror_.at, 4) + " m: it is no half model",
                             place(), "leave --symmetry away");
        }
    }

    void choose_reference() {
        if (options_.reference) {
            result_.reference = *options_.reference;
            result_.reference_from = "given";
        } else {
            reference_from_base();
        }
        half_reference_ = result_.reference;
        if (mirror_.axis >= 0) {
            half_reference_[static_cast<std::size_t>(mirror_.axis)] = mirror_.at;  // mirroring is about the plane
        }
    }

    /// Mid-length, mid-width, in the plane of the flat base (most of its area lies in it; a protrusion does not move it).
    void reference_from_base() {
        std::vector<const Part*> base;
        std::string names;
        for (const auto& part : parts_) {
            if (matches(options_.base, part.zone->name)) {
                base.push_back(&part);
                names += (names.empty() ? "'" : ", '") + part.zone->name + "'";
            }
        }
        Vector lower = lower_;
        Vector upper = upper_;
        if (!base.empty()) {
            lower.fill(std::numeric_limits<double>::infinity());
            upper.fill(-std::numeric_limits<double>::infinity());
            for (const Part* part : base) {
                widen(*part, lower, upper);
            }
        }
        Vector& r = result_.reference;
        for (std::size_t k = 0; k < 3; ++k) {
            r[k] = 0.5 * (lower[k] + upper[k]);
        }
        if (mirror_.axis >= 0) {
            r[static_cast<std::size_t>(mirror_.axis)] = mirror_.at;
        }
        if (base.empty()) {
            r = plus(r, axes_.up, lowest_along_up() - dot(r, axes_.up));
            result_.reference_from = "lowest point under the centre of the bounding box (no zone fits '" + options_.base + "')";
            warn("no zone is called '" + options_.base + "': moments are taken about the " + result_.reference_from);
            return;
        }
        result_.reference_from = "centre of the base (zone " + names + ")";
        const auto [normal, offset] = plane_of(base);
        if (std::abs(dot(normal, axes_.up)) > 0.5) {  // straight up or down, so that mid-length stays mid-length
            r = plus(r, axes_.up, (offset - dot(r, normal)) / dot(normal, axes_.up));
        }
    }

    /// Mean normal and the offset below which half of the area lies.
    [[nodiscard]] std::pair<Vector, double> plane_of(const std::vector<const Part*>& base) const {
        struct Face {
            double offset, area;
        };
        std::vector<Face> faces;
        Vector normal{};
        std::vector<std::pair<Vector, double>> centres;
        double area = 0;
        for (const Part* part : base) {
            for (std::size_t f = 0; f < part->surface->faces(); ++f) {
                const Vector a = area_of(*part, f);
                normal = plus(normal, a, dot(a, axes_.up) > 0 ? 1.0 : -1.0);
                centres.emplace_back(centre_of(*part, f), norm(a));
                area += norm(a);
            }
        }
        const double size = norm(normal);
        if (!(size > 0)) {
            return {axes_.up, 0};
        }
        normal = {normal[0] / size, normal[1] / size, normal[2] / size};
        if (mirror_.axis >= 0) {  // the other half's normals make the mean one lie in the plane
            normal[static_cast<std::size_t>(mirror_.axis)] = 0;
        }
        faces.reserve(centres.size());
        for (const auto& [centre, a] : centres) {
            faces.push_back({dot(centre, normal), a});
        }
        std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.offset < b.offset; });
        double below = 0;
        for (const auto& face : faces) {
            below += face.area;
            if (below >= 0.5 * area) {
                return {normal, face.offset};
            }
        }
        return {normal, faces.back().offset};
    }

    static Vector area_of(const Part& part, std::size_t face) {
        const auto first = part.surface->offsets()[face];
        const auto last = part.surface->offsets()[face + 1];
        const auto point = [&](Index i) {
            const double* x = part.surface->points().data() + 3 * part.surface->connectivity()[static_cast<std::size_t>(i)];
            return Vector{x[0], x[1], x[2]};
        };
        const Vector origin = point(first);
        Vector sum{};
        for (Index i = first + 1; i + 1 < last; ++i) {
            sum = plus(sum, cross(plus(point(i), origin, -1), plus(point(i + 1), origin, -1)), 0.5);
        }
        return sum;
    }

    [[nodiscard]] double lowest_along_up() const {
        double lowest = std::numeric_limits<double>::infinity();
        for (const auto& part : parts_) {
            const auto points = part.surface->points();
            for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
                lowest = std::min(lowest, dot({points[i], points[i + 1], points[i + 2]}, axes_.up));
            }
        }
        return lowest;
    }

    // ---- sums ----

    void settle() {
        if (options_.fluid != FluidSide::automatic) {
            for (auto& part : parts_) {
                part.sign = options_.fluid == FluidSide::as_in_file ? 1 : -1;
            }
            result_.orientation = options_.fluid == FluidSide::as_in_file ? "node order of the file, as asked for" : "node order of the file turned, as asked for";
            return;
        }
        std::vector<FacingZone> zones;
        for (const auto& part : parts_) {
            zones.push_back({part.zone->name, part.surface.get(), part.sums, part.zone->normals_into_fluid});
        }
        const Facing facing = settle_facing(zones, mirror_.axis < 0 && field_.dimension == 2 ? 2 : mirror_.axis, half_reference_);
        result_.orientation = facing.how;
        result_.problems.insert(result_.problems.end(), facing.problems.begin(), facing.problems.end());
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            parts_[i].sign = facing.signs[i];
        }
    }

    /// Both halves, and the moment moved from the mirror plane to the reference point.
    [[nodiscard]] Wrench whole(const Vector& force, const Vector& moment) const {
        Wrench wrench{force, moment};
        if (mirror_.axis >= 0) {
            for (int k = 0; k < 3; ++k) {
                const auto i = static_cast<std::size_t>(k);
                wrench.force[i] *= k == mirror_.axis ? 0 : 2;
                wrench.moment[i] *= k == mirror_.axis ? 2 : 0;  // a moment is a pseudo-vector
            }
        }
        wrench.moment = plus(wrench.moment, cross(plus(half_reference_, result_.reference, -1), wrench.force));
        return wrench;
    }

    [[nodiscard]] NamedLoads named(const Wrench& wrench) const {
        const Vector astern = {-axes_.forward[0], -axes_.forward[1], -axes_.forward[2]};
        const Vector down = {-axes_.up[0], -axes_.up[1], -axes_.up[2]};
        // 0.0 + makes minus zero plain zero.
        return {0.0 + dot(wrench.force, axes_.up),         0.0 + dot(wrench.force, astern),         0.0 + dot(wrench.force, axes_.starboard),
                0.0 + dot(wrench.moment, axes_.starboard), 0.0 + dot(wrench.moment, axes_.forward), 0.0 + dot(wrench.moment, down)};
    }

    void add_up() {
        Vector area_vector{};
        for (const auto& part : parts_) {
            ZoneLoads zone;
            zone.name = part.zone->name;
            zone.faces = part.surface->faces();
            zone.area = part.sums.area * (mirror_.axis >= 0 ? 2 : 1);
            const auto turned = [&](const Vector& v) { return Vector{part.sign * v[0], part.sign * v[1], part.sign * v[2]}; };
            zone.area_vector = whole(turned(part.sums.area_vector), {}).force;
            zone.pressure = whole(turned(part.sums.pressure_force), turned(part.sums.pressure_moment));
            zone.viscous = whole(part.sums.shear_force, part.sums.shear_moment);
            zone.turned = part.sign < 0;
            result_.area += zone.area;
            area_vector = plus(area_vector, zone.area_vector);
            result_.pressure = {plus(result_.pressure.force, zone.pressure.force), plus(result_.pressure.moment, zone.pressure.moment)};
            result_.viscous = {plus(result_.viscous.force, zone.viscous.force), plus(result_.viscous.moment, zone.viscous.moment)};
            result_.zones.push_back(std::move(zone));
        }
        result_.total = {plus(result_.pressure.force, result_.viscous.force), plus(result_.pressure.moment, result_.viscous.moment)};
        result_.named = named(result_.total);
        result_.named_pressure = named(result_.pressure);
        result_.named_viscous = named(result_.viscous);
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
        if (!result_.left_out.empty()) {
            tell_what_was_left_out();
        }
        const double by_kilopascal = 1000 * norm(result_.force_per_reference_pascal);
        const double force = norm(result_.total.force);
        if (by_kilopascal > 0.01 * force && result_.closure > 1e-9) {
            std::string text = "the surface is not closed (closure " + core::format_number(result_.closure, 3) + "): 1 kPa of reference pressure would change the force by " +
                               shown({1000 * result_.force_per_reference_pascal[0], 1000 * result_.force_per_reference_pascal[1], 1000 * result_.force_per_reference_pascal[2]}) + " N";
            const std::string half = half_model_hint();
            const std::string one = opening_zone();
            warn(text + (!one.empty() ? "; it closes without zone '" + one + "' (a ground?): name the zones of the body with --zones" : half.empty() ? "" : "; " + half));
        }
    }

    /// The one zone without which the surface closes; empty when there is none.
    [[nodiscard]] std::string opening_zone() const {
        for (const auto& without : result_.zones) {
            Vector area_vector{};
            for (const auto& zone : result_.zones) {
                area_vector = plus(area_vector, zone.area_vector, &zone == &without ? 0 : 1);
            }
            const double rest = result_.area - without.area;
            if (result_.zones.size() > 1 && rest > 0 && norm(area_vector) < 1e-3 * rest) {
                return without.name;
            }
        }
        return {};
    }

    /// An opening that looks along one axis where the surface ends: a half model whose plane was not named.
    [[nodiscard]] std::string half_model_hint() const {
        if (mirror_.axis >= 0) {
            return {};
        }
        const Vector& open = result_.force_per_reference_pascal;
        const double size = norm(plus(upper_, lower_, -1));
        for (std::size_t k = 0; k < 3; ++k) {
            const bool ends_at_zero = std::abs(lower_[k]) < 1e-3 * size || std::abs(upper_[k]) < 1e-3 * size;
            if (std::abs(open[k]) > 0.99 * norm(open) && ends_at_zero) {
                return std::string("a half model? then --symmetry ") + "xyz"[k];
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
        const double from = std::min(dot(lower_, axes_.forward), dot(upper_, axes_.forward));
        const double to = std::max(dot(lower_, axes_.forward), dot(upper_, axes_.forward));
        std::vector<Wrench> slices(steps);
        for (const auto& part : parts_) {
            for (std::size_t f = 0; f < part.surface->faces(); ++f) {
                const FaceSums sums = integrate_face(*part.surface, part.values, half_reference_, f);
                const double share = (dot(centre_of(part, f), axes_.forward) - from) / (to - from);
                auto& slice = slices[std::min(steps - 1, static_cast<std::size_t>(std::max(0.0, share) * static_cast<double>(steps)))];
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
            result_.stations.push_back({from + (to - from) * static_cast<double>(i + 1) / static_cast<double>(steps) - at_reference, named(whole(sum.force, sum.moment))});
        }
    }

    static Vector centre_of(const Part& part, std::size_t face) {
        Vector sum{};
        const auto first = part.surface->offsets()[face];
        const auto last = part.surface->offsets()[face + 1];
        for (auto i = first; i < last; ++i) {
            const double* x = part.surface->points().data() + 3 * part.surface->connectivity()[static_cast<std::size_t>(i)];
            sum = plus(sum, {x[0], x[1], x[2]}, 1.0 / static_cast<double>(last - first));
        }
        return sum;
    }

    void coefficients() {
        const LoadsReferences& given = options_.references;
        const auto density = given.density ? given.density : field_.density;
        if (!density || !given.speed || !(*given.speed > 0) || !(*density > 0)) {
            return;
        }
        const auto extent = [&](const Vector& axis) {
            double size = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const bool doubled = static_cast<int>(k) == mirror_.axis;
                size += std::abs(axis[k]) * (upper_[k] - lower_[k]) * (doubled ? 2 : 1);
            }
            return size;
        };
        LoadsCoefficients c;
        c.density = *density;
        c.speed = *given.speed;
        c.length = given.length.value_or(extent(axes_.forward));
        c.width = given.width.value_or(extent(axes_.starboard));
        c.height = given.height.value_or(extent(axes_.up));
        c.lengths_from = given.length && given.width && given.height ? "given" : given.length || given.width || given.height ? "given, others from the bounding box" : "bounding box";
        const double quarter_pi = std::atan(1.0);
        const double plan = 0.5 * c.density * c.speed * c.speed * quarter_pi * c.length * c.width;
        const double front = 0.5 * c.density * c.speed * c.speed * quarter_pi * c.width * c.height;
        c.lift = result_.named.lift_force / plan;
        c.drag = result_.named.drag_force / front;
        c.pitch_moment = result_.named.pitch_moment / (plan * c.length);
        result_.coefficients = c;
    }

    const Field& field_;
    const LoadsOptions& options_;
    core::Progress& progress_;
    Mirror mirror_;
    Axes axes_;
    std::vector<Part> parts_;
    Vector lower_{}, upper_{};
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
