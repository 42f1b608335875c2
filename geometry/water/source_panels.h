// Potential and velocity of triangles with a source of unit strength per area (1/r each), exact and from afar.
#pragma once

#include <array>

#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

class SourcePanel {
public:
    SourcePanel(const Vec3& a, const Vec3& b, const Vec3& c);

    [[nodiscard]] const Vec3& centre() const { return centre_; }
    [[nodiscard]] const Vec3& normal() const { return normal_; }
    [[nodiscard]] double area() const { return area_; }

    /// Integral of 1/|x - y| over the panel, m.
    [[nodiscard]] double potential(const Vec3& x) const;
    /// Its gradient in x; on the panel itself the mean of both sides (the part along the normal is then 0).
    [[nodiscard]] Vec3 gradient(const Vec3& x) const;

private:
    struct Exact {
        double potential = 0;
        Vec3 gradient;
    };
    /// Source: D. R. Wilton et al., "Potential integrals for uniform and linear source distributions on polygonal and
    /// polyhedral domains", IEEE Trans. Antennas Propag. 32, 1984, eqs. 5 and 6 (Hess and Smith 1967 for the same).
    [[nodiscard]] Exact exact(const Vec3& x) const;
    [[nodiscard]] bool far(double squared_distance) const { return squared_distance > far_; }

    std::array<Vec3, 3> corner_, along_, out_;
    Vec3 centre_, normal_;
    double area_ = 0, far_ = 0;
    std::array<double, 6> second_{};  // xx, yy, zz, xy, yz, zx: integrals of products of offsets from the centre
};

}  // namespace underbody::geometry
