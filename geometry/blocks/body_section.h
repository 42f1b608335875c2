// Horizontal sections of the exact (unbent) body in the plane where its ellipsoid is round. Internal to the block
// mesher.
#pragma once

#include <vector>

#include "geometry/blocks/grading.h"
#include "geometry/body/exact_body.h"

namespace underbody::geometry {

/// Scaled coordinates: X = x sqrt(b/a), Y = y sqrt(a/b), from the axis of the ellipsoid with the semi-axes a and b;
/// areas keep their size. Every section is star-shaped about the axis.
class BodySection {
public:
    explicit BodySection(const ExactBody& body);

    [[nodiscard]] const ExactBody& body() const { return body_; }
    /// Of the section at the midplane, m.
    [[nodiscard]] double largest() const { return largest_; }
    [[nodiscard]] double to_x() const { return to_x_; }  ///< x = X to_x()
    [[nodiscard]] double to_y() const { return 1 / to_x_; }
    /// Distance from the axis to the surface at a height above the base and an azimuth in [0, pi]: 0 nose, pi/2 port.
    [[nodiscard]] double radius(double height, double azimuth) const;
    [[nodiscard]] double rim(double azimuth) const { return radius(0, azimuth); }
    /// Azimuth in [0, pi] where the rim has a given X; the ends for an X beyond them.
    [[nodiscard]] double rim_azimuth(double x) const;
    /// Azimuths of the corners of the base in front and aft, which a grid line should meet; where there is none, 45
    /// and 135 degrees.
    [[nodiscard]] double front_corner() const { return front_corner_; }
    [[nodiscard]] double back_corner() const { return back_corner_; }

private:
    [[nodiscard]] double ellipsoid_radius(double height, double azimuth) const;

    const ExactBody& body_;
    double largest_ = 0, to_x_ = 1, front_corner_ = 0, back_corner_ = 0;
};

/// The line on the hull from the rim of the base up to a height, at one azimuth: points exactly on the surface by their
/// arc length in the scaled plane.
class FlankLine {
public:
    FlankLine(const BodySection& section, double azimuth, double height);
    [[nodiscard]] double length() const { return arcs_.back(); }
    /// (distance from the axis, height above the base)
    [[nodiscard]] Point2 at(double arc) const;

private:
    const BodySection& section_;
    double azimuth_, height_;
    std::vector<double> arcs_;
};

}  // namespace underbody::geometry
