// What is asked of the loads on a body, and what comes of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "postproc/field/vector_math.h"

namespace underbody::postproc {

/// Closure (see LoadsResult) up to which walls are the whole of a body, and up to which they tell its inside from
/// outside. Both are chosen, not measured.
constexpr double closed_within = 1e-3, nearly_closed_within = 0.01;

/// Lengths and flow that coefficients refer to. Coefficients come out only when density and speed are known.
struct LoadsReferences {
    std::optional<double> density;  ///< kg/m^3; default: the field's own
    std::optional<double> speed;    ///< m/s
    std::optional<double> length;   ///< m; default: the extent of the body along forward (the result says which)
    std::optional<double> width;    ///< m
    std::optional<double> height;   ///< m
};

/// Which side of the faces the fluid is on.
enum class FluidSide {
    automatic,  ///< as the importer knows it; where the file does not say, settled from the shape (the result says how)
    as_in_file,  ///< right-hand normals point into the fluid
    reversed,    ///< right-hand normals point out of the fluid
};

struct LoadsOptions {
    /// Patterns with * and ?. Empty: the walls of the body, that is all walls (or all surfaces with pressure where the
    /// file knows no walls) but those that cannot be part of it, such as a ground: see `LoadsResult::left_out`.
    std::vector<std::string> zones;
    std::optional<Vector> reference;  ///< m, file axes: where moments are taken; default: the centre of the base
    std::string base = "*base*";      ///< pattern of the zone whose centre is the default reference
    Vector forward = {1, 0, 0};       ///< file axes
    Vector up = {0, 0, 1};
    /// Half model: the plane's normal axis ("x", "y", "z"), optionally with its place ("y=0.1"). Empty: whole model.
    std::string symmetry;
    FluidSide fluid = FluidSide::automatic;
    double reference_pressure = 0;  ///< Pa, taken from all pressures
    LoadsReferences references;
    /// A two-dimensional case is half the section of a body of revolution about the x axis; files of Fluent that say so
    /// themselves need no telling.
    bool axisymmetric = false;
    int stations = 0;              ///< more than 0: running integral along the body in so many steps
    bool accept_problems = false;  ///< go on although the importer found errors (zero-area faces ...)
};

/// A force and its moment about a named point, file axes.
struct Wrench {
    Vector force{};   ///< N
    Vector moment{};  ///< N m, about LoadsResult::reference
};

/// The vehicle's sense (docs/conventions.md section 1): lift up, drag against the motion, side to starboard,
/// pitch nose up, roll starboard down, yaw bow to starboard; moments about LoadsResult::reference.
struct NamedLoads {
    double lift_force = 0;
    double drag_force = 0;
    double side_force = 0;
    double pitch_moment = 0;
    double roll_moment = 0;
    double yaw_moment = 0;
};

struct ZoneLoads {
    std::string name;
    std::size_t faces = 0;
    double area = 0;       ///< m^2 (both halves of a half model)
    Vector area_vector{};  ///< m^2, out of the body
    Wrench pressure;
    Wrench viscous;
    bool turned = false;  ///< its faces looked the other way in the file
};

/// Running integral from the tail to the nose: what the part of the body behind `position` carries.
struct LoadsStation {
    double position = 0;  ///< m, along forward from the reference point
    NamedLoads behind;
};

struct LoadsCoefficients {
    double lift = 0;          ///< lift / (1/2 rho v^2 pi/4 length width)
    double drag = 0;          ///< drag / (1/2 rho v^2 pi/4 width height)
    double pitch_moment = 0;  ///< moment / (1/2 rho v^2 pi/4 length width length)
    // Of a plane case, per metre depth: without the pi/4 of an ellipse, and the width is the metre.
    double density = 0, speed = 0, length = 0, width = 0, height = 0;
    std::string lengths_from;  ///< "given" or "bounding box"
};

/// A surface that was not summed because it is none of the body's, or is summed already.
struct LeftOutZone {
    enum class By { shape, name, doubled };
    std::string name;
    std::string why;
    By by = By::shape;  ///< `doubled`: it is of the body, but its faces stand in other zones too
};

/// The reference values that the solver itself uses for coefficients, as far as the file states them.
struct SolverReferences {
    std::optional<double> density, speed, area, length;  ///< kg/m^3, m/s, m^2, m
};

struct LoadsResult {
    std::string file;
    std::optional<double> time;  ///< of the field (s, or the iteration of a steady run), where the file says
    int dimension = 3;           ///< of the case: 2 for a plane or an axisymmetric one, whose faces are lines
    Wrench total;
    Wrench pressure;
    Wrench viscous;
    Vector reference{};
    std::string reference_from;           ///< "given", "centre of the base (zone 'base')", ...
    Vector forward{}, up{}, starboard{};  ///< the vehicle's axes as unit vectors of the file's
    int mirror_axis = -1;                 ///< 0, 1, 2: a half model, all sums are of both halves; -1: the body as it is
    NamedLoads named;                     ///< of the total
    NamedLoads named_pressure;
    NamedLoads named_viscous;
    std::vector<ZoneLoads> zones;
    std::vector<LeftOutZone> left_out;  ///< a ground, a tunnel, an inlet, a wall that stands twice in the file; only
                                        ///< when no zones were named
    double area = 0;                    ///< m^2
    Vector extent{};         ///< m, of the zones that were taken: forward, to starboard, up; half models doubled
    double length = 0;       ///< m, of the body: as given among the references, else its extent along forward
    std::string cut_across;  ///< "x", "y", "z" where the surface ends as that of a half model does; else empty
    double closure = 0;      ///< size of the summed area vector over the area: 0 for a closed surface
    Vector force_per_reference_pascal{};  ///< N/Pa: what 1 Pa added to every pressure would add to the force
    std::string depth;        ///< of a plane case: "per metre depth", "of the whole body of revolution"; else empty
    std::string values_from;  ///< "faces", "nodes", "cells", or "faces, nodes" when zones differ
    std::string orientation;  ///< how it is known which way the faces look
    std::optional<Vector> centre_of_pressure;  ///< m, on the forward line through the reference; none without lift
    std::optional<LoadsCoefficients> coefficients;
    SolverReferences solver_references;
    std::vector<LoadsStation> stations;
    core::Problems problems;  ///< open surface, no wall shear, orientation not settled, ...
};

}  // namespace underbody::postproc
