#include "geometry/body/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/error.h"
#include "core/text.h"
#include "geometry/body/exact_body.h"
#include "geometry/mesh/self_intersection.h"

namespace underbody::geometry {

namespace {

constexpr std::size_t faults_of_a_kind = 5;

class Faults {
public:
    explicit Faults(Certificate& certificate) : certificate_(certificate) {}
    void add(const std::string& what, const Vec3& where) {
        const auto same = std::count_if(certificate_.faults.begin(), certificate_.faults.end(),
                                        [&](const auto& f) { return f.what == what; });
        if (static_cast<std::size_t>(same) < faults_of_a_kind) {
            certificate_.faults.push_back({what, where});
        }
    }

private:
    Certificate& certificate_;
};

void check_edges(const SurfaceMesh& mesh, Certificate& certificate, Faults& faults) {
    std::vector<std::uint64_t> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto from = static_cast<std::uint32_t>(t[k]), to = static_cast<std::uint32_t>(t[(k + 1) % 3]);
            sides.push_back(std::uint64_t{std::min(from, to)} << 33 | std::uint64_t{std::max(from, to)} << 1 |
                            (from > to));
        }
    }
    std::sort(sides.begin(), sides.end());
    certificate.closed = certificate.oriented = !sides.empty();
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t j = i;
        std::size_t backward = 0;
        for (; j < sides.size() && sides[j] >> 1 == sides[i] >> 1; ++j) {
            backward += sides[j] & 1;
        }
        const auto middle = [&] {
            return 0.5 * (mesh.points[sides[i] >> 33] + mesh.points[(sides[i] >> 1) & 0xffffffffu]);
        };
        if (j - i != 2) {
            certificate.closed = false;
            faults.add(j - i == 1 ? "open edge" : "edge of " + std::to_string(j - i) + " triangles", middle());
        } else if (backward != 1) {
            certificate.oriented = false;
            faults.add("neighbours turned against each other", middle());
        }
        i = j;
    }
}

// Around each point, following the triangles from edge to edge must come back after all of them.
void check_fans(const SurfaceMesh& mesh, Certificate& certificate, Faults& faults) {
    const std::size_t count = mesh.points.size();
    std::vector<std::uint32_t> start(count + 1, 0);
    for (const Triangle& t : mesh.triangles) {
        for (const std::int32_t p : t) {
            ++start[static_cast<std::size_t>(p) + 1];
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        start[i + 1] += start[i];
    }
    std::vector<std::pair<std::int32_t, std::int32_t>> spokes(start.back());
    std::vector<std::uint32_t> fill(start.begin(), start.end() - 1);
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            spokes[fill[static_cast<std::size_t>(t[k])]++] = {t[(k + 1) % 3], t[(k + 2) % 3]};
        }
    }
    certificate.manifold = certificate.closed;
    for (std::size_t i = 0; i < count; ++i) {
        const auto first = spokes.begin() + start[i], last = spokes.begin() + start[i + 1];
        if (first == last) {
            continue;
        }
        std::int32_t at = first->second;
        std::ptrdiff_t steps = 1;
        for (; at != first->first && steps <= last - first; ++steps) {
            const auto next = std::find_if(first, last, [at](const auto& spoke) { return spoke.first == at; });
            if (next == last) {
                break;
            }
            at = next->second;
        }
        if (at != first->first || steps != last - first) {
            certificate.manifold = false;
            if (certificate.closed && certificate.oriented) {
                faults.add("two sheets meet in a point", mesh.points[i]);
            }
        }
    }
}

void measure_triangles(const SurfaceMesh& mesh, Certificate& certificate) {
    // The smallest angle lies opposite the shortest edge: sin = 2 A / (product of the other two).
    double smallest_sine = 1, largest_aspect = 1;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Vec3 &a = mesh.corner(i, 0), &b = mesh.corner(i, 1), &c = mesh.corner(i, 2);
        std::array<double, 3> edge{dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)};
        std::sort(edge.begin(), edge.end());
        const double twice_area = norm(cross(b - a, c - a));
        smallest_sine = std::min(smallest_sine, twice_area / std::sqrt(edge[1] * edge[2]));
        largest_aspect = std::max(largest_aspect, edge[2] / twice_area * 0.8660254037844386);
    }
    certificate.smallest_angle = std::asin(std::min(1.0, smallest_sine));
    certificate.largest_aspect_ratio = largest_aspect;
}

double signed_volume(const SurfaceMesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        sum += dot(mesh.corner(i, 0), cross(mesh.corner(i, 1), mesh.corner(i, 2)));
    }
    return sum / 6;
}

class DistanceToExact {
public:
    explicit DistanceToExact(const BodyShape& shape) : body_(shape) {}

    [[nodiscard]] const ExactBody& body() const { return body_; }

    [[nodiscard]] double operator()(Vec3 p, const std::string& patch) const {
        p.x += body_.base_centre();
        if (patch == "hull") {
            // Inside its own piece by the chord, further inside all others: the largest is the one.
            double d = body_.distance_to_ellipsoid(p);
            if (p.z < body_.depth()) {
                for (const Side side : {Side::front, Side::back, Side::port}) {
                    if (body_.cut(side)) {
                        d = std::max(d, body_.distance_to_side(p, side));
                    }
                }
            }
            return d;
        }
        const auto& nozzle = body_.shape().nozzle;
        if (patch == "nozzle_bore") {
            const Vec3 q = body_.unbent(p);
            return nozzle->diameter / 2 - std::hypot(q.x - body_.shape().base_x(nozzle->position), q.y);
        }
        if (patch == "nozzle") {
            return body_.unbent(p).z - nozzle->depth;
        }
        return body_.distance_to_base(p);
    }

private:
    ExactBody body_;
};

}  // namespace

Certificate certify(const SurfaceMesh& mesh, core::Progress& progress) {
    Certificate certificate;
    Faults faults(certificate);
    if (mesh.triangles.empty()) {
        faults.add("no triangles", {});
        return certificate;
    }
    check_edges(mesh, certificate, faults);
    progress.check();
    check_fans(mesh, certificate, faults);
    measure_triangles(mesh, certificate);
    if (certificate.closed && certificate.oriented && signed_volume(mesh) <= 0) {
        certificate.oriented = false;
        faults.add("inside out", mesh.centre(0));
    }
    progress.check();
    const auto pairs = self_intersections(mesh, faults_of_a_kind, progress);
    certificate.self_intersection_free = pairs.empty();
    for (const auto& [s, t] : pairs) {
        faults.add(s == t ? "triangle without area" : "self-intersection", 0.5 * (mesh.centre(s) + mesh.centre(t)));
    }
    return certificate;
}

Certificate certify(const SurfaceMesh& mesh, const BodyShape& shape, core::Progress& progress) {
    Certificate certificate = certify(mesh, progress);
    const DistanceToExact distance(shape);
    Certificate::Exact exact;
    double squares = 0, weights = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Vec3 &a = mesh.corner(i, 0), &b = mesh.corner(i, 1), &c = mesh.corner(i, 2);
        const std::string& patch = mesh.patch_names[static_cast<std::size_t>(mesh.patch[i])];
        const double weight = norm(mesh.area_vector(i));
        for (const Vec3& p : {(a + b + c) / 3, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)}) {
            const double d = std::abs(distance(p, patch));
            squares += weight * d * d;
            weights += weight;
            if (d > exact.distance_largest) {
                exact.distance_largest = d;
                exact.where = p;
            }
        }
        if (i % 4096 == 0) {
            progress.check();
        }
    }
    exact.distance_rms = std::sqrt(squares / weights);
    exact.volume = distance.body().volume();
    exact.volume_error = signed_volume(mesh) / exact.volume - 1;
    certificate.exact = exact;
    return certificate;
}

void require(const Certificate& certificate, const std::string& name) {
    if (certificate.passed()) {
        return;
    }
    const Certificate::Fault& fault = certificate.faults.front();
    const auto mm = [](double v) { return core::format_number(1000 * v, 6); };
    throw core::InputError(
        "surface",
        name + " is no sound surface: " + fault.what + " at (" + mm(fault.where.x) + ", " + mm(fault.where.y) + ", " +
            mm(fault.where.z) + ") mm" +
            (certificate.faults.size() > 1 ? " and " + core::counted(certificate.faults.size() - 1, "fault") + " more"
                                           : ""),
        {}, "repair the surface there: a mesher would fail at the same place");
}

void to_json(nlohmann::json& json, const Certificate& certificate) {
    json = {{"closed", certificate.closed},
            {"oriented", certificate.oriented},
            {"manifold", certificate.manifold},
            {"self_intersection_free", certificate.self_intersection_free},
            {"passed", certificate.passed()},
            {"smallest_angle", certificate.smallest_angle},
            {"largest_aspect_ratio", certificate.largest_aspect_ratio},
            {"faults", nlohmann::json::array()}};
    for (const Certificate::Fault& fault : certificate.faults) {
        json["faults"].push_back({{"what", fault.what}, {"where", {fault.where.x, fault.where.y, fault.where.z}}});
    }
    if (certificate.exact) {
        json["distance_rms"] = certificate.exact->distance_rms;
        json["distance_largest"] = certificate.exact->distance_largest;
        json["exact_volume"] = certificate.exact->volume;
        json["volume_error"] = certificate.exact->volume_error;
    }
}

}  // namespace underbody::geometry
